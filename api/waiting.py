"""Long polls: look at a job until it is what the client waits for, or time is up."""

from __future__ import annotations

import time
from collections.abc import Callable

from starlette.concurrency import run_in_threadpool

from api.services import Services
from store.job import Job


async def wait_until(services: Services, job: Job, wait_s: float, reached: Callable[[Job], bool]) -> Job:
    """The job as soon as `reached` says so, after `wait_s` at the latest, at once when the server stops.

    Between two looks no thread is held."""
    deadline = time.monotonic() + wait_s
    with services.watch.watching(job.id) as watched:
        while not reached(job) and not services.drain.begun and (left := deadline - time.monotonic()) > 0:
            await watched.news(job.event_seq, left)
            job = await run_in_threadpool(services.jobs.get, job.workspace, job.id)
    return job


def has_ended(job: Job) -> bool:
    """True once nothing more happens by itself."""
    return job.status.is_finished


def has_left(status: str) -> Callable[[Job], bool]:
    """True once the job has another status than that one."""
    return lambda job: job.status != status
