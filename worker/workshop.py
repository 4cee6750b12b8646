"""What every job of one worker process shares."""

from __future__ import annotations

import os
import socket
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import takewhile

from core.schema.processes import PROCESSES
from sandbox.limits import Limits
from sandbox.nursery import Nursery
from store.audit import Audit
from store.blobs import Blobs
from store.callbacks import Callbacks
from store.checkpoints import Checkpoints
from store.cohorts import Cohorts
from store.database import Database
from store.doorbell import Doorbell
from store.idempotency import IdempotencyKeys
from store.jobs import Jobs
from store.open_blobs import open_blobs
from store.parked import Parked
from store.references import References
from store.retention import Retention
from store.retention_policy import RetentionPolicies, RetentionPolicy
from store.settings import Settings
from worker.closing import Closing

TARGET = "core.processes.registry:run"  # executed in the child; the worker itself never imports it


@dataclass(frozen=True, slots=True)
class Workshop:
    """One per process; everything in it is safe to use from all threads of the pool."""

    settings: Settings
    db: Database
    jobs: Jobs
    cohorts: Cohorts
    callbacks: Callbacks
    checkpoints: Checkpoints
    blobs: Blobs
    references: References
    keys: IdempotencyKeys
    audit: Audit
    parked: Parked
    retention: Retention
    doorbell: Doorbell
    nursery: Nursery
    closing: Closing
    host: str
    name: str  # of this worker, in leases and logs: `host:process id`
    target: str = TARGET

    @classmethod
    def open(cls, settings: Settings, *, target: str = TARGET, preload: Sequence[str] | None = None) -> Workshop:
        """Connects to nothing yet; `preload` defaults to the target's module."""
        db = Database(settings)
        jobs = Jobs(db)
        return cls(
            settings=settings,
            db=db,
            jobs=jobs,
            cohorts=Cohorts(db, jobs),
            callbacks=Callbacks(db),
            checkpoints=Checkpoints(db, settings.checkpoint_bytes),
            blobs=open_blobs(settings, db),
            references=References(db),
            audit=Audit(db),
            parked=Parked(db),
            retention=Retention(db, RetentionPolicies(db, RetentionPolicy.of(settings))),
            keys=IdempotencyKeys(db, settings.idempotency_hours),
            doorbell=Doorbell(settings.broker_url, settings.queue),
            nursery=Nursery(
                (target.partition(":")[0],) if preload is None else preload, require_confinement=settings.require_confinement
            ),
            closing=Closing(settings.drain_s),
            host=socket.gethostname(),
            name=f"{socket.gethostname()}:{os.getpid()}",
            target=target,
        )

    def limits_of(self, process: str) -> Limits:
        """Of one attempt of a job of this process."""
        known = PROCESSES.get(process)
        return replace(self.limits, forks=known is not None and known.starts_processes)

    @property
    def limits(self) -> Limits:
        """Of one attempt of any job."""
        return Limits(
            memory_bytes=min(self.settings.job_memory_bytes, self.settings.worker_memory_bytes),
            cpu_s=int(self.settings.job_cpu_s) or 1,
            file_bytes=self.settings.job_file_bytes,
            wall_s=self.settings.job_wall_s,
        )

    def close(self) -> None:
        """End every child, then all connections."""
        self.nursery.stop()
        self.doorbell.close()
        self.db.close()

    def announce_all(self, attempts: Sequence[tuple[str, int]]) -> bool:
        """Ring for jobs that wait, up to the first the broker does not take: False, and the reconciler tries again.

        That they were rung is written down at once for all: a commit for each would keep those who accept waiting."""
        rung = list(takewhile(lambda attempt: self.doorbell.ring(*attempt), attempts))
        if rung:
            self.jobs.mark_all_rung(rung)
        return len(rung) == len(attempts)
