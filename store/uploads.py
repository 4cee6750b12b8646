"""Uploads that come in pieces: what was announced, and how many bytes of it are safely here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from uuid import uuid4

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from core.errors import StateError
from store.blobs import Blob
from store.database import Database
from store.quotas import Quotas
from store.records import UploadPartRow, UploadRow
from store.storable import storable, storable_text
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class Upload:
    """`received` of `length` bytes are on disk. fields: unit and name, as the multipart form has them. mesh_id: made of it."""

    id: str
    file_name: str
    fields: Mapping[str, str]
    length: int
    received: int
    mesh_id: str | None
    created_at: datetime
    expires_at: datetime


class Uploads:
    """The row says how much of the file counts; bytes behind that were never acknowledged."""

    def __init__(self, db: Database, hours: float = 24.0, quotas: Quotas | None = None) -> None:
        self._db = db
        self._quotas = quotas
        self._hours = hours

    def create(self, workspace: WorkspaceId, *, file_name: str, fields: Mapping[str, str], length: int) -> Upload:
        """Announce an upload of `length` bytes, which are taken from the quota. Raises LimitError `quota.bytes`."""
        with self._db.session() as session:
            if self._quotas is not None:
                self._quotas.require_room_for_bytes(workspace, length, session)
            now = self._db.now(session)
            row = UploadRow(
                id=str(uuid4()),
                workspace=workspace,
                file_name=storable_text(file_name),
                fields=storable(dict(fields)),
                length=length,
                received=0,
                created_at=now,
                expires_at=now + timedelta(hours=self._hours),
            )
            session.add(row)
            session.flush()
            return _upload(row)

    def get(self, workspace: WorkspaceId, upload_id: str) -> Upload:
        """Raises StateError `upload.not_found`."""
        with self._db.reading() as session:
            return _upload(_known(session.get(UploadRow, upload_id), workspace, upload_id))

    def advance(self, workspace: WorkspaceId, upload_id: str, received: int) -> Upload:
        """That many bytes are on disk now. Raises StateError `upload.not_found`."""
        with self._db.session() as session:
            row = _known(session.get(UploadRow, upload_id, with_for_update=True), workspace, upload_id)
            row.received = received
            row.expires_at = self._db.now(session) + timedelta(hours=self._hours)
            return _upload(row)

    def add_part(self, workspace: WorkspaceId, upload_id: str, start: int, part: Blob) -> Upload:
        """The bytes from `start` on are that blob. Of several hosts that write at one place, one is first.

        Raises StateError `upload.not_found`, `upload.offset_differs`."""
        with self._db.session() as session:
            row = _known(session.get(UploadRow, upload_id, with_for_update=True), workspace, upload_id)
            if row.received != start:
                raise StateError(
                    "upload.offset_differs",
                    f"another request was quicker: the server has {row.received} bytes now, not {start}",
                    received=row.received,
                )
            session.add(UploadPartRow(upload_id=upload_id, start=start, size=part.size, sha256=part.sha256))
            row.received = start + part.size
            row.expires_at = self._db.now(session) + timedelta(hours=self._hours)
            return _upload(row)

    def parts(self, workspace: WorkspaceId, upload_id: str) -> Sequence[Blob]:
        """In the order of their bytes. Raises StateError `upload.not_found`."""
        with self._db.reading() as session:
            _known(session.get(UploadRow, upload_id), workspace, upload_id)
            query = select(UploadPartRow).where(UploadPartRow.upload_id == upload_id).order_by(UploadPartRow.start)
            return [Blob(row.sha256, row.size) for row in session.scalars(query)]

    def finish(self, workspace: WorkspaceId, upload_id: str, mesh_id: str, *, session: Session | None = None) -> None:
        """A mesh was made of it, by `session` if there is one: its bytes never count twice. Its parts go with the next sweep.

        Raises StateError `upload.not_found`."""
        with self._db.session(session) as work:
            _known(work.get(UploadRow, upload_id, with_for_update=True), workspace, upload_id).mesh_id = mesh_id
            work.execute(delete(UploadPartRow).where(UploadPartRow.upload_id == upload_id))

    def delete(self, workspace: WorkspaceId, upload_id: str, *, session: Session | None = None) -> None:
        """By `session` if there is one. Raises StateError `upload.not_found`."""
        with self._db.session(session) as work:
            work.delete(_known(work.get(UploadRow, upload_id, with_for_update=True), workspace, upload_id))

    def sweep(self) -> int:
        """Forget uploads nobody went on with; returns how many. Their files go with `known`."""
        with self._db.session() as session:
            gone = session.scalars(delete(UploadRow).where(UploadRow.expires_at < self._db.now(session)).returning(UploadRow.id))
            return len(gone.all())

    def known(self) -> frozenset[str]:
        """The ids of all uploads: any other file is nobody's."""
        with self._db.reading() as session:
            return frozenset(session.scalars(select(UploadRow.id)))


def _known(row: UploadRow | None, workspace: WorkspaceId, upload_id: str) -> UploadRow:
    if row is None or row.workspace != workspace:
        raise StateError("upload.not_found", f"there is no upload {upload_id}", upload=upload_id)
    return row


def _upload(row: UploadRow) -> Upload:
    return Upload(row.id, row.file_name, dict(row.fields), row.length, row.received, row.mesh_id, row.created_at, row.expires_at)
