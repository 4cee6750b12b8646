"""Which waiting job a worker takes: fair between workspaces, and only what the memory of its host can hold (ADR 0014)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime

from core.schema.expectation import JobQueue

NEVER = datetime(1, 1, 1, tzinfo=UTC)


@dataclass(frozen=True, slots=True)
class Room:
    """What a worker can take. `free` are the queues it has a slot for now, `queues` all it serves.

    `memory_bytes` is what all jobs of the host may need together, whichever process of it runs them; a job is counted with what
    it is expected to need, but never with more than `job_memory_bytes`, where its child is ended."""

    host: str
    free: frozenset[JobQueue]
    queues: frozenset[JobQueue]
    memory_bytes: int
    job_memory_bytes: int
    patience_s: float

    def need_bytes(self, expected_bytes: int) -> int:
        """What to count a job with."""
        return min(expected_bytes, self.job_memory_bytes)


@dataclass(frozen=True, slots=True)
class Running:
    """A job under way anywhere."""

    workspace: str
    queue: JobQueue
    host: str
    need_bytes: int


@dataclass(frozen=True, slots=True)
class Head:
    """The job of a workspace and queue that has waited longest; `served_at`: when that workspace was last given a worker."""

    job_id: str
    workspace: str
    queue: JobQueue
    queued_at: datetime
    need_bytes: int
    served_at: datetime | None


def in_turn(heads: Iterable[Head], running: Iterable[Running]) -> list[Head]:
    """Whose turn it is: the workspace with the fewest jobs under way, then the one served longest ago; within it, first come."""
    under_way: dict[str, int] = {}
    for job in running:
        under_way[job.workspace] = under_way.get(job.workspace, 0) + 1
    return sorted(
        heads, key=lambda head: (under_way.get(head.workspace, 0), head.served_at or NEVER, head.queued_at, head.job_id)
    )


def largest_admitted(room: Room, heads: Iterable[Head], running: Iterable[Running], now: datetime) -> Mapping[JobQueue, int]:
    """For each queue with a free slot, what a job may need at most to be taken now.

    A job that fits the host, but not beside those that run, would wait for ever behind smaller ones. Once it has waited longer
    than `patience_s` the host takes only fast jobs, and of these no more than will still fit beside it."""
    here = [job for job in running if job.host == room.host]
    free_bytes = room.memory_bytes - sum(job.need_bytes for job in here)
    limits = dict.fromkeys(room.free, free_bytes)
    waiting_long = [
        head
        for head in heads
        if free_bytes < head.need_bytes <= room.memory_bytes and (now - head.queued_at).total_seconds() > room.patience_s
    ]
    if waiting_long:
        kept_for = min(waiting_long, key=lambda head: (head.queued_at, head.job_id))
        fast_bytes = sum(job.need_bytes for job in here if job.queue is JobQueue.FAST)
        beside = min(free_bytes, room.memory_bytes - kept_for.need_bytes - fast_bytes)
        limits = dict.fromkeys(room.free & {JobQueue.FAST}, beside)
    return limits
