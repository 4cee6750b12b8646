"""After the commit: tell the workers. A thread does it, so the client's answer waits neither for broker nor for database."""

from __future__ import annotations

import logging
import queue
import threading
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
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


@dataclass(frozen=True, slots=True)
class CohortBells:
    """Jobs that are announced together."""

    cohort_id: str
    jobs: Sequence[Job]


class Ringer:
    """Thread-safe; `ring` never waits.

    Bells are rung at once, the marks that they were follow for a quarter second together. Whatever gets lost here, with this
    process or with the broker, the reconciler of a worker announces a few seconds later: the job table is the truth."""

    def __init__(self, doorbell: Doorbell, jobs: Jobs, commits: GroupCommit) -> None:
        self._doorbell = doorbell
        self._jobs = jobs
        self._commits = commits
        self._waiting: queue.SimpleQueue[Job | CohortBells | None] = queue.SimpleQueue()
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

    def ring_cohort(self, cohort_id: str, jobs: Sequence[Job]) -> None:
        """The same for committed jobs of one cohort: one canvas, a bell for each of them."""
        if jobs:
            self._waiting.put(CohortBells(cohort_id, jobs))

    def _loop(self) -> None:
        open_ = True
        while open_:
            waiting, open_ = self._next()
            try:
                self._announce(waiting)
                if self._rung and (not open_ or len(self._rung) >= MOST_AT_ONCE or time.monotonic() >= self._mark_at):
                    self._mark()
            except IntegumentError as error:
                logger.warning("what was accepted is announced later: %s", error)
            except Exception:
                logger.exception("what was accepted is announced later")

    def _next(self) -> tuple[list[Job | CohortBells], bool]:
        """All that wait: one at least, unless marks are due before; False if it is the end."""
        found: list[Job | CohortBells] = []
        try:
            one = self._waiting.get(timeout=max(self._mark_at - time.monotonic(), 0.0) if self._rung else None)
        except queue.Empty:
            return found, True
        while one is not None:
            found.append(one)
            if len(found) == MOST_AT_ONCE or self._waiting.empty():
                return found, True
            one = self._waiting.get()
        return found, False

    def _announce(self, waiting: Sequence[Job | CohortBells]) -> None:
        bells: Counter[JobQueue] = Counter()
        for one in waiting:
            if isinstance(one, CohortBells):
                if not self._doorbell.ring_all(one.cohort_id, [(job.id, job.attempt, job.queue) for job in one.jobs]):
                    return
                self._keep_in_mind(one.jobs)
                continue
            if bells[one.queue] < BELLS and not self._doorbell.ring(one.id, one.attempt, one.queue):
                return  # the others would wait as long in vain
            bells[one.queue] += 1
            self._keep_in_mind([one])

    def _keep_in_mind(self, jobs: Sequence[Job]) -> None:
        if not self._rung:
            self._mark_at = time.monotonic() + MARK_S
        self._rung += [(job.id, job.attempt) for job in jobs]

    def _mark(self) -> None:
        """What the database does not take now, the reconciler rings for once more."""
        rung, self._rung = self._rung, []
        self._commits.run(partial(self._jobs.mark_all_rung, rung), LAST)
