"""Which workers there are: each gives word every few seconds, by the clock of the database."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum

from sqlalchemy import delete, select

from core.schema.expectation import JobQueue
from store.crew_records import WorkerRow
from store.database import Database
from store.settings import Settings
from store.storable import storable_text

STALE_BEATS = 6
KEPT_S = 3600.0  # for how long one that vanished is still told of


class WorkerState(StrEnum):
    """What its last word says."""

    ALIVE = "alive"
    DRAINING = "draining"  # alive, but takes no more jobs
    LOST = "lost"  # silent for too long, and did not say goodbye


@dataclass(frozen=True, slots=True)
class WorkerWord:
    """What a worker says of itself. memory_bytes: what its jobs may use together; disk_free_bytes: where they work;
    queues: whose jobs it takes."""

    name: str
    host: str
    version: str
    concurrency: int
    memory_bytes: int
    disk_free_bytes: int
    draining: bool = False
    queues: tuple[JobQueue, ...] = tuple(JobQueue)


@dataclass(frozen=True, slots=True)
class Worker:
    """The last word of a worker, and what it means `silent_s` later."""

    word: WorkerWord
    state: WorkerState
    started_at: datetime
    seen_at: datetime
    silent_s: float


class Workers:
    """Thread-safe. One row per worker process; nothing that decides about jobs is read from here."""

    def __init__(self, db: Database, settings: Settings) -> None:
        self._db = db
        self._stale_s = stale_s(settings)

    def beat(self, word: WorkerWord) -> None:
        """I live, and this is what I am."""
        with self._db.session() as session:
            now = self._db.now(session)
            row = session.get(WorkerRow, word.name)
            if row is None:
                row = WorkerRow(name=word.name, started_at=now)
                session.add(row)
            row.host, row.version = storable_text(word.host, 255), storable_text(word.version, 64)
            row.concurrency, row.draining = word.concurrency, word.draining
            row.memory_bytes, row.disk_free_bytes, row.seen_at = word.memory_bytes, word.disk_free_bytes, now
            row.queues = ",".join(word.queues)

    def leave(self, name: str) -> None:
        """It stopped in good order."""
        with self._db.session() as session:
            session.execute(delete(WorkerRow).where(WorkerRow.name == name))

    def list(self) -> Sequence[Worker]:
        """By host, then by the time they started."""
        with self._db.reading() as session:
            now = self._db.now(session)
            rows = session.scalars(select(WorkerRow).order_by(WorkerRow.host, WorkerRow.started_at, WorkerRow.name))
            return [self._worker(row, now) for row in rows]

    def served_queues(self) -> frozenset[JobQueue]:
        """Those whose jobs somebody is there to take."""
        alive = (worker for worker in self.list() if worker.state is WorkerState.ALIVE)
        return frozenset(queue for worker in alive for queue in worker.word.queues)

    def sweep(self, kept_s: float = KEPT_S) -> int:
        """Forget those that vanished longer ago; returns how many."""
        with self._db.session() as session:
            before = self._db.now(session) - timedelta(seconds=max(kept_s, self._stale_s))
            return len(session.scalars(delete(WorkerRow).where(WorkerRow.seen_at < before).returning(WorkerRow.name)).all())

    def _worker(self, row: WorkerRow, now: datetime) -> Worker:
        silent_s = max((now - row.seen_at).total_seconds(), 0.0)
        state = WorkerState.DRAINING if row.draining else WorkerState.ALIVE
        if silent_s > self._stale_s:
            state = WorkerState.LOST
        queues = tuple(map(JobQueue, row.queues.split(",")))
        word = WorkerWord(
            *(row.name, row.host, row.version, row.concurrency, row.memory_bytes, row.disk_free_bytes, row.draining, queues)
        )
        return Worker(word, state, row.started_at, row.seen_at, silent_s)


def stale_s(settings: Settings) -> float:
    """After this silence a worker counts as lost: 60 s as the settings come."""
    return STALE_BEATS * settings.reconcile_s + settings.lease_s
