"""How many jobs will be taken before one that waits: the order of `store.choice`, counted and not played through."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, func, select, tuple_
from sqlalchemy.orm import Session

from core.schema.expectation import JobQueue
from store.choice import NEVER
from store.instant import Instant
from store.job import JobStatus
from store.records import JobRow, TurnRow


@dataclass(frozen=True, slots=True)
class _Line:
    """The jobs of one workspace that wait, and what decides whose turn it is."""

    waiting: int
    running: int
    served_at: datetime
    head: tuple[datetime, str]


def find_queue_position(session: Session, workspace: str, job_id: str, queue: JobQueue, queued_at: datetime) -> int:
    """1 for the job that is taken next if none ends meanwhile and all fit.

    Fast jobs have a slot of their own, so only fast ones count for them; for a heavy one all do. With k jobs of a workspace under
    way, its first waiting job belongs to round k + 1, the next to the round after; who enters a round first is served first."""
    counted: list[ColumnElement[bool]] = [JobRow.status == JobStatus.ACCEPTED]
    if queue is JobQueue.FAST:
        counted.append(JobRow.queue == queue)
    lines = _lines(session, counted)
    ahead = session.execute(
        select(func.count()).where(
            *counted, JobRow.workspace == workspace, tuple_(JobRow.queued_at, JobRow.id) < (queued_at, job_id)
        )
    ).scalar_one()
    mine = lines.pop(workspace, None)
    if mine is None:  # taken while we looked
        return 1
    job_round = mine.running + ahead + 1
    before = ahead
    for line in lines.values():
        before += min(line.waiting, max(job_round - 1 - line.running, 0))
        in_same_round = line.running < job_round <= line.running + line.waiting
        before += in_same_round and _enters_first(line, mine)
    return before + 1


def _enters_first(line: _Line, other: _Line) -> bool:
    """Who has more under way enters later rounds only, and is first there: the others have just been served."""
    return (-line.running, line.served_at, line.head) < (-other.running, other.served_at, other.head)


def _lines(session: Session, counted: list[ColumnElement[bool]]) -> dict[str, _Line]:
    waiting = session.execute(
        select(
            JobRow.workspace,
            func.count().label("number"),
            func.min(JobRow.queued_at, type_=Instant()).label("since"),
        )
        .where(*counted)
        .group_by(JobRow.workspace)
    ).all()
    under_way = select(JobRow.workspace, func.count()).where(JobRow.status == JobStatus.RUNNING).group_by(JobRow.workspace)
    running = dict(session.execute(under_way).all())
    served = dict(session.execute(select(TurnRow.workspace, TurnRow.served_at)).all())
    return {
        line.workspace: _Line(
            line.number, running.get(line.workspace, 0), served.get(line.workspace, NEVER), (line.since, line.workspace)
        )
        for line in waiting
    }
