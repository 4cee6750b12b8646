"""What a workspace may hold: bytes stored, and jobs that wait or run. Compared and used in one transaction."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import ColumnElement, bindparam, func, select
from sqlalchemy.orm import InstrumentedAttribute, Session

from core.errors import LimitError
from store.database import Database
from store.job import JobStatus
from store.records import JobRow, MeshRow, UploadRow, WorkspaceRow
from store.workspace import WorkspaceId

LIVE = (JobStatus.ACCEPTED, JobStatus.RUNNING)


@dataclass(frozen=True, slots=True)
class Usage:
    """bytes: files sent and outputs made, and uploads under way at their full length. jobs: waiting and running."""

    bytes: int
    jobs: int


class Quotas:
    """The limits of each workspace, and those of the settings where it has none of its own; 0 means no limit."""

    def __init__(self, db: Database, *, default_bytes: int, default_jobs: int) -> None:
        self._db = db
        self._default_bytes = default_bytes
        self._default_jobs = default_jobs

    def require_room_for_job(self, workspace: WorkspaceId, session: Session) -> None:
        """To be called in the transaction that queues the job. Raises LimitError `quota.jobs`, `quota.bytes`."""
        row = self._locked(workspace, session)
        limit = self._default_jobs if row.quota_jobs is None else row.quota_jobs
        if limit and (jobs := _count_jobs(workspace, session)) >= limit:
            raise LimitError(
                "quota.jobs",
                f"{jobs} jobs of workspace {workspace} wait or run, and it may have {limit}; try again when one has ended",
                jobs=jobs,
                limit=limit,
            )
        self._require_bytes(row, 0, session)

    def require_room_for_bytes(self, workspace: WorkspaceId, size: int, session: Session) -> None:
        """To be called in the transaction that stores them. Raises LimitError `quota.bytes`."""
        self._require_bytes(self._locked(workspace, session), size, session)

    def check_room_for_bytes(self, workspace: WorkspaceId, size: int) -> None:
        """The same without holding anything: whether to begin at all. Raises LimitError `quota.bytes`."""
        with self._db.reading() as session:
            row = session.get_one(WorkspaceRow, workspace)
            self._require_bytes(row, size, session)

    def usage(self, workspace: WorkspaceId) -> Usage:
        """Counted now."""
        with self._db.reading() as session:
            return Usage(_sum_bytes(workspace, session), _count_jobs(workspace, session))

    def _locked(self, workspace: WorkspaceId, session: Session) -> WorkspaceRow:
        """Two requests of one workspace take turns, so they cannot both use what is left; rows that refer to it go on."""
        return session.scalars(_LOCKED, {"workspace": workspace}).one()

    def _require_bytes(self, row: WorkspaceRow, size: int, session: Session) -> None:
        limit = self._default_bytes if row.quota_bytes is None else row.quota_bytes
        if not limit:
            return
        used = _sum_bytes(WorkspaceId(row.id), session)
        if used + size > limit or used >= limit:
            raise LimitError(
                "quota.bytes",
                f"workspace {row.id} holds {used} of the {limit} bytes it may, {size} more do not fit; "
                "remove meshes and finished jobs, or ask an operator",
                used_bytes=used,
                more_bytes=size,
                limit_bytes=limit,
            )


def _count_jobs(workspace: WorkspaceId, session: Session) -> int:
    return session.execute(_LIVE_JOBS, {"workspace": workspace}).scalar_one()


def _sum_bytes(workspace: WorkspaceId, session: Session) -> int:
    def total(column: InstrumentedAttribute[int], *where: ColumnElement[bool]) -> int:
        return int(session.execute(select(func.coalesce(func.sum(column), 0)).where(*where)).scalar_one())

    meshes = total(MeshRow.size_bytes, MeshRow.workspace == workspace)
    outputs = total(JobRow.output_bytes, JobRow.workspace == workspace)
    announced = total(UploadRow.length, UploadRow.workspace == workspace, UploadRow.mesh_id.is_(None))
    return meshes + outputs + announced


# made once: to put such a statement together takes longer than to run it
_LOCKED = select(WorkspaceRow).where(WorkspaceRow.id == bindparam("workspace")).with_for_update(key_share=True)
_LIVE_JOBS = select(func.count()).select_from(JobRow).where(JobRow.workspace == bindparam("workspace"), JobRow.status.in_(LIVE))
