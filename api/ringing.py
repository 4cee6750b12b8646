"""After the commit: tell the workers. A thread does it, so the client's answer waits neither for broker nor for database."""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections import Counter
from functools import partial

from core.errors import IntegumentError
from core.schema.expectation import JobQueue
from store.doorbell import Doorbell
from store.group_commit import LAST, GroupCommit
from store.job import Job
from store.jobs import Jobs

MOST_AT_ONCE = 200  # marked by one transaction
MARK_S = 0.25  # between a bell and the mark that it was rung: accepting waits for no second transaction
BELLS = 16  # of one moment and queue: a worker that hears one takes all it has room for

logger = logging.getLogger(__name__)


class Ringer:
    """Thread-safe; `ring` never waits.

    Bells are rung at once, the marks that they were follow for a quarter second together. Whatever gets lost here, with this
    process or with the broker, the reconciler of a worker announces a few seconds later: the job table is the truth."""

    def __init__(self, doorbell: Doorbell, jobs: Jobs, commits: GroupCommit) -> None:
        self._doorbell = doorbell
        self._jobs = jobs
        self._commits = commits
        self._waiting: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
        self._rung: list[tuple[str, int]] = []
        self._mark_at = 0.0
        self._thread = threading.Thread(target=self._loop, name="ringer", daemon=True)

    def start(self) -> None:
        """Begin to announce."""
        self._thread.start()

    def stop(self) -> None:
        """Returns when all that was accepted is announced, or left to the reconciler."""
        if self._thread.is_alive():
            self._waiting.put(None)
            self._thread.join()

    def ring(self, job: Job) -> None:
        """Announce a committed job soon."""
        self._waiting.put(job)

    def _loop(self) -> None:
        open_ = True
        while open_:
            jobs, open_ = self._next()
            try:
                self._announce(jobs)
                if self._rung and (not open_ or len(self._rung) >= MOST_AT_ONCE or time.monotonic() >= self._mark_at):
                    self._mark()
            except IntegumentError as error:
                logger.warning("%d jobs are announced later: %s", len(jobs), error)
            except Exception:
                logger.exception("%d jobs are announced later", len(jobs))

    def _next(self) -> tuple[list[Job], bool]:
        """All that wait: one at least, unless marks are due before; False if it is the end."""
        jobs: list[Job] = []
        try:
            job = self._waiting.get(timeout=max(self._mark_at - time.monotonic(), 0.0) if self._rung else None)
        except queue.Empty:
            return jobs, True
        while job is not None:
            jobs.append(job)
            if len(jobs) == MOST_AT_ONCE or self._waiting.empty():
                return jobs, True
            job = self._waiting.get()
        return jobs, False

    def _announce(self, jobs: list[Job]) -> None:
        bells: Counter[JobQueue] = Counter()
        for job in jobs:
            if bells[job.queue] < BELLS and not self._doorbell.ring(job.id, job.attempt, job.queue):
                return  # the others would wait as long in vain
            bells[job.queue] += 1
            if not self._rung:
                self._mark_at = time.monotonic() + MARK_S
            self._rung.append((job.id, job.attempt))

    def _mark(self) -> None:
        """What the database does not take now, the reconciler rings for once more."""
        rung, self._rung = self._rung, []
        self._commits.run(partial(self._jobs.mark_all_rung, rung), LAST)
