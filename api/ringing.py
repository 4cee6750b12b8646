"""After the commit: tell the workers. A thread does it, so the client's answer waits neither for broker nor for database."""

from __future__ import annotations

import logging
import queue
import threading

from core.errors import IntegumentError
from store.doorbell import Doorbell
from store.job import Job
from store.jobs import Jobs

MOST_AT_ONCE = 200  # announced by one transaction

logger = logging.getLogger(__name__)


class Ringer:
    """Thread-safe; `ring` never waits.

    What is accepted within the same moment is marked as announced in one transaction. Whatever gets lost here, with this
    process or with the broker, the reconciler of a worker announces a few seconds later: the job table is the truth."""

    def __init__(self, doorbell: Doorbell, jobs: Jobs) -> None:
        self._doorbell = doorbell
        self._jobs = jobs
        self._waiting: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
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
            except IntegumentError as error:
                logger.warning("%d jobs are announced later: %s", len(jobs), error)
            except Exception:
                logger.exception("%d jobs are announced later", len(jobs))

    def _next(self) -> tuple[list[Job], bool]:
        """All that wait, one at least; False if it is the end."""
        jobs: list[Job] = []
        job = self._waiting.get()
        while job is not None:
            jobs.append(job)
            if len(jobs) == MOST_AT_ONCE or self._waiting.empty():
                return jobs, True
            job = self._waiting.get()
        return jobs, False

    def _announce(self, jobs: list[Job]) -> None:
        rung = []
        for job in jobs:
            if not self._doorbell.ring(job.id, job.attempt, job.queue):
                break  # the others would wait as long in vain
            rung.append((job.id, job.attempt))
        if rung:
            self._jobs.mark_all_rung(rung)
