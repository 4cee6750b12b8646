"""The table of workspaces."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import select
from sqlalchemy.exc import IntegrityError

from core.errors import StateError
from store.database import Database
from store.records import WorkspaceRow
from store.workspace import Workspace, WorkspaceId, require_workspace_id


class Workspaces:
    """Made by operators, never removed: what belongs to one would have no owner."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def create(self, name: str, *, quota_bytes: int | None = None, quota_jobs: int | None = None) -> Workspace:
        """Raises InputError `workspace.id_invalid`, StateError `workspace.exists`."""
        workspace = require_workspace_id(name)
        try:
            with self._db.session() as session:
                row = WorkspaceRow(id=workspace, created_at=self._db.now(session), quota_bytes=quota_bytes, quota_jobs=quota_jobs)
                session.add(row)
        except IntegrityError:
            raise StateError("workspace.exists", f"there is a workspace {name} already", workspace=name) from None
        return _workspace(row)

    def get(self, name: str) -> Workspace:
        """Raises StateError `workspace.not_found`."""
        with self._db.reading() as session:
            row = session.get(WorkspaceRow, name)
            if row is None:
                raise StateError("workspace.not_found", f"there is no workspace {name[:80]}", workspace=name[:80])
            return _workspace(row)

    def list(self) -> Sequence[Workspace]:
        """By name."""
        with self._db.reading() as session:
            return [_workspace(row) for row in session.scalars(select(WorkspaceRow).order_by(WorkspaceRow.id))]


def _workspace(row: WorkspaceRow) -> Workspace:
    return Workspace(WorkspaceId(row.id), row.created_at, row.quota_bytes, row.quota_jobs)
