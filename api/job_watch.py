"""One look at the database for all who wait for news of a job: streams and long polls cost nothing while nothing happens."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterator
from contextlib import contextmanager

from starlette.concurrency import run_in_threadpool

from api.drain import Drain
from core.errors import IntegumentError
from store.job_heads import JobHead, JobHeads

logger = logging.getLogger(__name__)


class Watched:
    """A job somebody waits for. `head` is as it was at the last look; None: the job is gone."""

    def __init__(self, job_id: str) -> None:
        self.job_id = job_id
        self.head: JobHead | None = JobHead(0, finished=False)
        self.count = 0  # of those who wait
        self._changed = asyncio.Event()

    def see(self, head: JobHead | None) -> None:
        """Take the result of a look."""
        if head != self.head:
            self.head = head
            self.wake()

    def wake(self) -> None:
        """Let everybody look for himself."""
        self._changed.set()
        self._changed = asyncio.Event()

    async def news(self, seen: int, longest_s: float) -> None:
        """Returns once the job is gone or told more than event `seen`, once somebody wakes us, or after `longest_s`."""
        changed = self._changed
        if self.head is not None and self.head.seq <= seen:
            try:
                async with asyncio.timeout(longest_s):
                    await changed.wait()
            except TimeoutError:
                return


class JobWatch:
    """For the event loop of one application; `run` is its only task."""

    def __init__(self, heads: JobHeads, drain: Drain, poll_s: float) -> None:
        self._heads = heads
        self._drain = drain
        self._poll_s = poll_s
        self._watched: dict[str, Watched] = {}
        self._wanted = asyncio.Event()

    @contextmanager
    def watching(self, job_id: str) -> Iterator[Watched]:
        """The job is looked at until the block ends."""
        watched = self._watched.setdefault(job_id, Watched(job_id))
        watched.count += 1
        self._wanted.set()
        try:
            yield watched
        finally:
            watched.count -= 1
            if not watched.count:
                del self._watched[job_id]

    async def run(self) -> None:
        """Look as often as the settings say while anybody waits; the beginning of the drain wakes all."""
        while not self._drain.begun:
            if not self._watched:
                self._wanted.clear()
                await self._wanted.wait()
            try:
                heads = await run_in_threadpool(self._heads.of, tuple(self._watched))
            except IntegumentError as error:
                logger.warning("those who wait for jobs wait on: %s", error)
            else:
                for job_id in heads.keys() | self._watched.keys():
                    if job_id in self._watched:
                        self._watched[job_id].see(heads.get(job_id))
            await self._drain.pause(self._poll_s)
        for watched in self._watched.values():
            watched.wake()
