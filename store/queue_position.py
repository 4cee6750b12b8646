"""How many jobs will be taken before one that waits: the order of `store.choice`, counted and not played through."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Select, bindparam, exists, func, select, tuple_, type_coerce
from sqlalchemy.orm import Session

from core.schema.expectation import JobQueue
from store.choice import NEVER
from store.instant import Instant
from store.job import JobStatus
from store.records import JobRow, TurnRow, WorkspaceRow


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
    only_fast = queue is JobQueue.FAST
    lines = _lines(session, only_fast)
    ahead = session.execute(_AHEAD[only_fast], {"workspace": workspace, "queued_at": queued_at, "job_id": job_id}).scalar_one()
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


def _lines(session: Session, only_fast: bool) -> dict[str, _Line]:
    return {
        line.workspace: _Line(line.waiting, line.running, line.served_at or NEVER, (line.since, line.workspace))
        for line in session.execute(_WAITING[only_fast])
    }


def _counted(only_fast: bool) -> list[ColumnElement[bool]]:
    return [JobRow.status == JobStatus.ACCEPTED, *([JobRow.queue == JobQueue.FAST] if only_fast else [])]


def _ahead(only_fast: bool) -> Select[int]:
    """Those of the same workspace that wait longer."""
    place = tuple_(bindparam("queued_at", type_=Instant()), bindparam("job_id"))
    return select(func.count()).where(
        *_counted(only_fast), JobRow.workspace == bindparam("workspace"), tuple_(JobRow.queued_at, JobRow.id) < place
    )


def _waiting(only_fast: bool) -> Select[Any]:
    """From workspaces to their jobs: each count reads a stretch of one index, however many jobs have ended."""
    of_workspace = [JobRow.workspace == WorkspaceRow.id, *_counted(only_fast)]
    under_way = [JobRow.workspace == WorkspaceRow.id, JobRow.status == JobStatus.RUNNING]
    return (
        select(
            WorkspaceRow.id.label("workspace"),
            select(func.count()).select_from(JobRow).where(*of_workspace).scalar_subquery().label("waiting"),
            select(func.count()).select_from(JobRow).where(*under_way).scalar_subquery().label("running"),
            type_coerce(select(func.min(JobRow.queued_at)).where(*of_workspace).scalar_subquery(), Instant()).label("since"),
            TurnRow.served_at,
        )
        .outerjoin(TurnRow, TurnRow.workspace == WorkspaceRow.id)
        .where(exists().where(*of_workspace))
    )


# made once: to put such a statement together takes longer than to run it
_AHEAD = {only_fast: _ahead(only_fast) for only_fast in (False, True)}
_WAITING = {only_fast: _waiting(only_fast) for only_fast in (False, True)}
