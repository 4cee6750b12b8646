"""Which blobs are still needed."""

from __future__ import annotations

from sqlalchemy import select, union
from sqlalchemy.orm import Session

from store.database import Database
from store.records import JobCheckpointRow, JobInputRow, JobOutputRow, MeshRow, UploadPartRow


class References:
    """Every column that names a blob is listed here; a test holds the list complete."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def all(self) -> frozenset[str]:
        """The blobs some mesh, job input, output, checkpoint or upload refers to: what `Blobs.sweep` must keep."""
        with self._db.reading() as session:
            return self.seen_by(session)

    def seen_by(self, session: Session) -> frozenset[str]:
        """The same, as that transaction sees the tables."""
        query = union(
            select(MeshRow.sha256),
            select(MeshRow.canonical_sha256),
            select(JobInputRow.sha256),
            select(JobOutputRow.sha256),
            select(JobCheckpointRow.sha256),
            select(UploadPartRow.sha256),
        )
        return frozenset(session.scalars(query))
