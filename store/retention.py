"""Removes what is older than its days: in small transactions, beside a running service, and never what a live job needs.

Bytes need no care here: a job names the blobs it reads itself, so they outlive the job or upload they came from."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, Select, and_, delete, exists, func, or_, select, update
from sqlalchemy.orm import Session

from store.callback import CallbackState
from store.database import Database
from store.job_selector import FINISHED
from store.records import CallbackRow, CohortRow, EventRow, JobInputRow, JobRow, MeshRow
from store.retention_policy import RetentionPolicies
from store.workspace import WorkspaceId

JOBS_AT_A_TIME = 50
MESHES_AT_A_TIME = 200
EVENTS_AT_A_TIME = 20_000  # of a job that talked without end, alone
SWEEP_S = 5.0
TRIMMED = ("progress", "log")  # how a job ended is told as long as the job is


@dataclass(frozen=True, slots=True)
class Expired:
    """How much of a workspace is, or was, older than its days. events_of: jobs whose progress and log lines are."""

    jobs: int = 0
    meshes: int = 0
    events_of: int = 0

    @property
    def is_nothing(self) -> bool:
        """Nothing to tell."""
        return not (self.jobs or self.meshes or self.events_of)

    def __add__(self, other: Expired) -> Expired:
        return Expired(self.jobs + other.jobs, self.meshes + other.meshes, self.events_of + other.events_of)


class Retention:
    """Safe to run in several places at once: what one removes another does not find."""

    def __init__(self, db: Database, policies: RetentionPolicies) -> None:
        self._db = db
        self._policies = policies

    def count(self) -> dict[WorkspaceId, Expired]:
        """What the next sweeps remove."""
        found = {}
        with self._db.reading() as session:
            for workspace, (jobs, meshes, events) in self._limits(session).items():
                found[workspace] = Expired(
                    _count(session, _old_jobs(workspace, jobs)) if jobs else 0,
                    _count(session, _unused_meshes(workspace, meshes)) if meshes else 0,
                    _count(session, _talkative(workspace, events)) if events else 0,
                )
        return found

    def sweep(self, limit_s: float = SWEEP_S) -> Expired:
        """Remove it, as far as the time goes; the next call goes on."""
        ends_at, swept = time.monotonic() + limit_s, Expired()
        with self._db.reading() as session:
            limits = self._limits(session)
        for workspace, (jobs, meshes, events) in limits.items():
            while jobs and time.monotonic() < ends_at and (gone := self._remove_jobs(workspace, jobs)):
                swept += Expired(jobs=gone)
            while events and time.monotonic() < ends_at and (gone := self._trim_events(workspace, events)):
                swept += Expired(events_of=gone)
            while meshes and time.monotonic() < ends_at and (gone := self._remove_meshes(workspace, meshes)):
                swept += Expired(meshes=gone)
        return swept

    def _limits(self, session: Session) -> dict[WorkspaceId, tuple[datetime | None, datetime | None, datetime | None]]:
        """Before when jobs, meshes and events of each workspace are too old; None: never."""
        now = self._db.now(session)

        def before(days: float) -> datetime | None:
            return now - timedelta(days=days) if days else None

        return {
            workspace: (before(policy.jobs_days), before(policy.meshes_days), before(policy.events_days))
            for workspace, policy in self._policies.all().items()
        }

    def _remove_jobs(self, workspace: WorkspaceId, before: datetime) -> int:
        with self._db.session() as session:
            query = _old_jobs(workspace, before).order_by(JobRow.finished_at).limit(JOBS_AT_A_TIME)
            ids = _few(session.execute(query.with_for_update(skip_locked=True)).all())
            session.execute(delete(JobRow).where(JobRow.id.in_(ids)))
            _remove_empty_cohorts(session, workspace, before)
            return len(ids)

    def _remove_meshes(self, workspace: WorkspaceId, before: datetime) -> int:
        with self._db.session() as session:
            query = _unused_meshes(workspace, before).limit(MESHES_AT_A_TIME)
            ids = session.scalars(query.with_for_update(skip_locked=True)).all()
            session.execute(delete(MeshRow).where(MeshRow.id.in_(ids)))
            return len(ids)

    def _trim_events(self, workspace: WorkspaceId, before: datetime) -> int:
        with self._db.session() as session:
            query = _talkative(workspace, before).order_by(JobRow.finished_at).limit(JOBS_AT_A_TIME)
            ids = _few(session.execute(query.with_for_update(skip_locked=True)).all())
            session.execute(delete(EventRow).where(EventRow.job_id.in_(ids), EventRow.type.in_(TRIMMED)))
            session.execute(update(JobRow).where(JobRow.id.in_(ids)).values(events_trimmed_at=self._db.now(session)))
            return len(ids)


def _old_jobs(workspace: WorkspaceId, before: datetime) -> Select[str, int]:
    """Whoever subscribed to a job is told of it first: that is given up after three days at the latest."""
    untold = exists().where(CallbackRow.job_id == JobRow.id, CallbackRow.state == CallbackState.PENDING)
    return _ended(workspace, before).where(~untold)


def _talkative(workspace: WorkspaceId, before: datetime) -> Select[str, int]:
    """Not trimmed since they ended: a retry makes new events."""
    return _ended(workspace, before).where(or_(JobRow.events_trimmed_at.is_(None), JobRow.events_trimmed_at < JobRow.finished_at))


def _remove_empty_cohorts(session: Session, workspace: WorkspaceId, before: datetime) -> None:
    """With the last of its jobs a cohort goes."""
    of_it = exists().where(or_(JobRow.cohort_id == CohortRow.id, JobRow.id == CohortRow.summary_job_id))
    session.execute(delete(CohortRow).where(CohortRow.workspace == workspace, CohortRow.finished_at < before, ~of_it))


def _ended(workspace: WorkspaceId, before: datetime) -> Select[str, int]:
    return select(JobRow.id, JobRow.event_seq).where(
        JobRow.workspace == workspace, JobRow.finished_at < before, JobRow.status.in_(FINISHED)
    )


def _unused_meshes(workspace: WorkspaceId, before: datetime) -> Select[str]:
    """Those no job there is reads; the same bytes count as the same mesh."""
    reads: ColumnElement[bool] = and_(JobInputRow.sha256 == MeshRow.canonical_sha256, JobRow.workspace == MeshRow.workspace)
    read = exists().where(JobInputRow.job_id == JobRow.id, reads)
    return select(MeshRow.id).where(MeshRow.workspace == workspace, MeshRow.created_at < before, ~read)


def _few(found: Iterable[tuple[str, int]]) -> list[str]:
    """The first of them, at least one, that have not too many events to be removed at once."""
    ids: list[str] = []
    events = 0
    for job_id, count in found:
        events += count
        if ids and events > EVENTS_AT_A_TIME:
            break
        ids.append(job_id)
    return ids


def _count(session: Session, query: Select[str] | Select[str, int]) -> int:
    return session.execute(select(func.count()).select_from(query.subquery())).scalar_one()
