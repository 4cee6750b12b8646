"""How long what is done is kept: nothing goes by itself until an operator sets days."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import select
from sqlalchemy.orm import Session

from core.errors import StateError
from store.database import Database
from store.records import WorkspaceRow
from store.settings import Settings
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class RetentionPolicy:
    """Days; 0 keeps for ever. jobs: since they ended, with their results. meshes: since they were uploaded, if no job there is
    reads them. events: progress and log lines of jobs, since those ended."""

    jobs_days: float
    meshes_days: float
    events_days: float

    @classmethod
    def of(cls, settings: Settings) -> RetentionPolicy:
        """Of the server."""
        return cls(settings.keep_jobs_days, settings.keep_meshes_days, settings.keep_events_days)

    def expires_at(self, finished_at: datetime | None) -> datetime | None:
        """When a job that ended then is removed; None: never."""
        if finished_at is None or not self.jobs_days:
            return None
        return finished_at + timedelta(days=self.jobs_days)


@dataclass(frozen=True, slots=True)
class OwnRetention:
    """What a workspace says itself; None: as the server."""

    jobs_days: float | None
    meshes_days: float | None
    events_days: float | None

    def over(self, default: RetentionPolicy) -> RetentionPolicy:
        """What holds."""

        def first(own: float | None, otherwise: float) -> float:
            return otherwise if own is None else own

        return RetentionPolicy(
            first(self.jobs_days, default.jobs_days),
            first(self.meshes_days, default.meshes_days),
            first(self.events_days, default.events_days),
        )


class RetentionPolicies:
    """The days of every workspace. Thread-safe."""

    def __init__(self, db: Database, default: RetentionPolicy) -> None:
        self._db = db
        self.default = default

    def policy(self, workspace: WorkspaceId, session: Session) -> RetentionPolicy:
        """What holds in a workspace."""
        row = session.get(WorkspaceRow, workspace)
        return self.default if row is None else _own(row).over(self.default)

    def own(self, workspace: WorkspaceId) -> OwnRetention:
        """What it says itself. Raises StateError `workspace.not_found`."""
        with self._db.reading() as session:
            return _own(_known(session, workspace))

    def all(self) -> dict[WorkspaceId, RetentionPolicy]:
        """What holds in each workspace, by name."""
        with self._db.reading() as session:
            rows = session.scalars(select(WorkspaceRow).order_by(WorkspaceRow.id))
            return {WorkspaceId(row.id): _own(row).over(self.default) for row in rows}

    def set(self, workspace: WorkspaceId, own: OwnRetention) -> RetentionPolicy:
        """Holds from the next sweep on; returns what holds now. Raises StateError `workspace.not_found`."""
        with self._db.session() as session:
            row = _known(session, workspace)
            row.keep_jobs_days, row.keep_meshes_days, row.keep_events_days = own.jobs_days, own.meshes_days, own.events_days
            return own.over(self.default)


def _known(session: Session, workspace: WorkspaceId) -> WorkspaceRow:
    row = session.get(WorkspaceRow, workspace)
    if row is None:
        raise StateError("workspace.not_found", f"there is no workspace {workspace[:80]}", workspace=workspace[:80])
    return row


def _own(row: WorkspaceRow) -> OwnRetention:
    return OwnRetention(row.keep_jobs_days, row.keep_meshes_days, row.keep_events_days)
