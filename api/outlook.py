"""What a job that waits may expect: its place in the queue, and whether anybody is there to take it."""

from __future__ import annotations

import time
from dataclasses import dataclass

from core.schema.expectation import JobQueue
from store.job import Job, JobStatus
from store.jobs import Jobs
from store.workers import Workers

FRESH_S = 1.0  # workers give word every few seconds: to ask the table for every answer would tell nothing more


@dataclass(frozen=True, slots=True)
class Outlook:
    """position: counted from 1, None if the job does not wait; served_queues: those a living worker takes jobs from."""

    served_queues: frozenset[JobQueue]
    position: int | None = None

    def message_of(self, job: Job) -> str:
        """Its own message, and that nobody is there to take it, if so."""
        if job.status is not JobStatus.ACCEPTED or job.queue in self.served_queues:
            return job.message
        return f"{job.message}; {describe_unserved(job.queue, self.served_queues)}"


class Outlooks:
    """Thread-safe. Looks at the workers once a second at most."""

    def __init__(self, jobs: Jobs, workers: Workers, fresh_s: float = FRESH_S) -> None:
        self._jobs = jobs
        self._workers = workers
        self._fresh_s = fresh_s
        self._seen: tuple[float, frozenset[JobQueue]] | None = None

    def of(self, job: Job) -> Outlook:
        """That of a job which may have been taken or removed meanwhile. Raises StateError `job.not_found`."""
        return Outlook(self._served(), self._jobs.queue_position(job.workspace, job.id))

    def of_accepted(self, job: Job) -> Outlook:
        """That of a job which was accepted a moment ago."""
        return Outlook(self._served(), self._jobs.position_of(job.workspace, job))

    def without_place(self) -> Outlook:
        """For lists, where nobody counts who is before whom."""
        return Outlook(self._served())

    def _served(self) -> frozenset[JobQueue]:
        seen, now = self._seen, time.monotonic()
        if seen is None or now - seen[0] > self._fresh_s:
            self._seen = seen = (now, self._workers.served_queues())
        return seen[1]


def describe_unserved(queue: JobQueue, served_queues: frozenset[JobQueue]) -> str:
    """Why jobs of a queue wait."""
    return f"no living worker takes {queue} jobs" if served_queues else "no living worker is there"
