"""The hands of a worker: one thread looks for jobs, one per job supervises it."""

from __future__ import annotations

import logging
import threading
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

from core.errors import IntegumentError, LimitError
from core.schema.expectation import JobQueue
from store.choice import Room
from store.disk_floor import DiskFloor
from store.job import Job
from worker.task import run_job
from worker.workshop import Workshop

logger = logging.getLogger(__name__)

WAKE_S = 0.5  # how soon whoever waits for room sees that the worker stops

Run = Callable[[Workshop, Job, Callable[[], None]], None]


class Crew:
    """Looks when a bell was heard, when a job has ended, and every `look_s`; claims until nothing more is due or fits.

    `worker_concurrency` jobs compute at a time, and `worker_fast_slots` fast ones more, so that heavy ones never fill all slots.
    A job leaves its slot when it computes no more: while its results are stored and written down the next one has begun."""

    def __init__(self, workshop: Workshop, run: Run = run_job) -> None:
        self._workshop = workshop
        self._run = run
        settings = workshop.settings
        self._slots, self._fast_slots = settings.worker_concurrency, settings.worker_fast_slots
        self._queues = frozenset(settings.worker_queues)
        self._bell = threading.Event()
        self._changed = threading.Condition()
        self._at_work: Counter[JobQueue] = Counter()  # jobs that compute
        self._in_hand = 0  # jobs that do not, too
        self._most_in_hand = 2 * (self._slots + self._fast_slots)
        self._disk = DiskFloor(settings.data_dir, settings.disk_floor_bytes)
        self._had_disk = True
        self._hands = ThreadPoolExecutor(self._most_in_hand, thread_name_prefix="job")
        self._looker = threading.Thread(target=self._loop, name="crew", daemon=True)

    def start(self) -> None:
        """Begin with a look at once."""
        self._bell.set()
        self._looker.start()

    def ring(self) -> None:
        """Something waits: look now. Returns when there is room for a job, so that bells nobody here can answer go elsewhere."""
        self._bell.set()
        with self._changed:
            while not self.free_queues() and not self._workshop.closing.has_begun:
                self._changed.wait(WAKE_S)

    def drain(self) -> None:
        """Returns when the worker has been told to stop and its last job has ended or was handed back."""
        self._bell.set()
        if self._looker.is_alive():
            self._looker.join()
        self._hands.shutdown()

    def free_queues(self) -> frozenset[JobQueue]:
        """The queues a job may be taken from now, as far as slots go.

        No more jobs are being stored than compute: a store that is away is waited for."""
        with self._changed:
            if self._in_hand >= self._most_in_hand:
                return frozenset()
            if self._at_work.total() < self._slots:
                return self._queues
            if self._at_work[JobQueue.FAST] < self._fast_slots:
                return self._queues & {JobQueue.FAST}
            return frozenset()

    def _loop(self) -> None:
        while not self._workshop.closing.has_begun:
            self._bell.wait(self._workshop.settings.look_s)
            self._bell.clear()
            try:
                while self._take_one():
                    pass
            except IntegumentError as error:
                logger.warning("no job can be claimed now: %s", error)
            except Exception:
                logger.exception("a look for jobs failed; the next one follows")

    def _take_one(self) -> bool:
        """Claim the next job and hand it to a thread; False if there is none for us now."""
        free = self.free_queues()
        if not free or self._workshop.closing.has_begun:
            return False
        settings = self._workshop.settings
        if not self._has_disk():
            return False
        room = Room(
            host=self._workshop.host,
            free=free,
            queues=self._queues,
            memory_bytes=settings.worker_memory_bytes,
            job_memory_bytes=self._workshop.limits.memory_bytes,
            patience_s=settings.memory_patience_s,
        )
        job = self._workshop.jobs.claim_next(self._workshop.name, settings.lease_s, room)
        if job is None:
            return False
        with self._changed:
            self._at_work[job.queue] += 1
            self._in_hand += 1
        self._hands.submit(self._supervise, job)
        return True

    def _has_disk(self) -> bool:
        """Said once when it changes: on a full disk every job would fail, and another host may have room."""
        try:
            self._disk.require()
        except LimitError as error:
            if self._had_disk:
                logger.warning("no job is taken: %s", error)
            self._had_disk = False
            return False
        if not self._had_disk:
            logger.warning("there is room on the disk again: jobs are taken")
        self._had_disk = True
        return True

    def _supervise(self, job: Job) -> None:
        slot = _Slot(lambda: self._leave(job))
        try:
            self._run(self._workshop, job, slot.leave)
        finally:
            slot.leave()
            with self._changed:
                self._in_hand -= 1
            self._look_again()

    def _leave(self, job: Job) -> None:
        with self._changed:
            self._at_work[job.queue] -= 1
        self._look_again()

    def _look_again(self) -> None:
        with self._changed:
            self._changed.notify_all()
        self._bell.set()


class _Slot:
    """Left once, by whoever comes first. For one thread."""

    def __init__(self, on_leave: Callable[[], None]) -> None:
        self._on_leave = on_leave
        self._is_left = False

    def leave(self) -> None:
        """The second time nothing happens."""
        if not self._is_left:
            self._is_left = True
            self._on_leave()
