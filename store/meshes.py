"""Uploaded meshes: what was sent, and the canonical form jobs read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any
from uuid import uuid4

from sqlalchemy import bindparam, func, or_, select, tuple_
from sqlalchemy.orm import Session

from core.errors import StateError
from store.blobs import Blobs
from store.database import Database
from store.job_words import WORDS_AT_MOST
from store.page import Page, from_cursor, to_cursor
from store.quotas import Quotas
from store.records import MeshRow
from store.storable import storable, storable_text
from store.workspace import WorkspaceId

CANONICAL_MEDIA_TYPE = "application/x-integument-mesh"


@dataclass(frozen=True, slots=True)
class MeshUpload:
    """A file that was received and read: `path` holds the bytes as sent, `canonical_path` what the intake made of them.

    volume, field, coil: what there is in a label volume, a field or a coil, which have no vertices and faces; None for a mesh."""

    path: Path
    canonical_path: Path
    name: str
    file_name: str
    unit: str
    format: str
    vertices: int
    faces: int
    extents_mm: tuple[float, float, float]
    findings: tuple[Mapping[str, Any], ...] = ()
    arrays: tuple[Mapping[str, Any], ...] = ()
    volume: Mapping[str, Any] | None = None
    field: Mapping[str, Any] | None = None
    coil: Mapping[str, Any] | None = None


@dataclass(frozen=True, slots=True)
class MeshRecord:
    """A mesh this server holds. `sha256` and `size_bytes` are of the file as sent; lengths are in mm whatever its unit."""

    id: str
    name: str
    file_name: str
    unit: str
    format: str
    size_bytes: int
    sha256: str
    canonical_sha256: str
    vertices: int
    faces: int
    extents_mm: tuple[float, float, float]
    findings: tuple[Mapping[str, Any], ...]
    created_at: datetime
    arrays: tuple[Mapping[str, Any], ...] = ()
    volume: Mapping[str, Any] | None = None
    field: Mapping[str, Any] | None = None
    coil: Mapping[str, Any] | None = None


class Meshes:
    """The table of uploads, and their bytes among the blobs. To a workspace the meshes of others do not exist."""

    def __init__(self, db: Database, blobs: Blobs, quotas: Quotas | None = None) -> None:
        self._db = db
        self._blobs = blobs
        self._quotas = quotas

    def create(
        self,
        workspace: WorkspaceId,
        upload: MeshUpload,
        *,
        reserved_bytes: int = 0,
        session: Session | None = None,
        also: Callable[[MeshRecord, Session], None] = lambda _record, _session: None,
    ) -> MeshRecord:
        """Store both files, then the row: nothing half-way. `reserved_bytes` of the quota are taken for it already.

        `also` is done in the transaction of the row: the files may be large, so it is not open while they are copied.

        Raises LimitError `storage.full`, `quota.bytes`."""
        original = self._blobs.put_file(upload.path)
        canonical = self._blobs.put_file(upload.canonical_path)
        with self._db.session(session) as work:
            if self._quotas is not None:
                self._quotas.require_room_for_bytes(workspace, original.size - reserved_bytes, work)
            row = MeshRow(
                id=str(uuid4()),
                workspace=workspace,
                name=storable_text(upload.name),
                file_name=storable_text(upload.file_name),
                unit=upload.unit,
                format=upload.format,
                size_bytes=original.size,
                sha256=original.sha256,
                canonical_sha256=canonical.sha256,
                vertices=upload.vertices,
                faces=upload.faces,
                extents_mm=list(upload.extents_mm),
                findings=storable([dict(finding) for finding in upload.findings]),
                arrays=storable([dict(array) for array in upload.arrays]),
                volume=_stored(upload.volume),
                field=_stored(upload.field),
                coil=_stored(upload.coil),
                created_at=self._db.now(work),
            )
            work.add(row)
            work.flush()
            record = _record(row)
            also(record, work)
            return record

    def get(self, workspace: WorkspaceId, mesh_id: str) -> MeshRecord:
        """Raises StateError `mesh.not_found`."""
        with self._db.reading() as session:
            return _record(_owned(session, workspace, mesh_id))

    def list(self, workspace: WorkspaceId, *, text: str = "", limit: int = 50, cursor: str | None = None) -> Page[MeshRecord]:
        """Newest first; every word of `text` occurs in the name or the file's. Raises InputError `cursor.invalid`."""
        newest_first = (MeshRow.created_at.desc(), MeshRow.id.desc())
        query = select(MeshRow).where(MeshRow.workspace == workspace).order_by(*newest_first).limit(limit + 1)
        for word in text.split()[:WORDS_AT_MOST]:
            told = func.lower(MeshRow.name + " " + MeshRow.file_name + " " + MeshRow.id)
            shown = "".join(letter for letter in word if letter.isprintable())  # PostgreSQL takes no zero byte
            query = query.where(or_(*(told.contains(form, autoescape=True) for form in (shown, shown.lower()))))
        if cursor is not None:
            query = query.where(tuple_(MeshRow.created_at, MeshRow.id) < from_cursor(cursor))
        with self._db.reading() as session:
            rows = session.scalars(query).all()
            items = tuple(_record(row) for row in rows[:limit])
            return Page(items, to_cursor(items[-1].created_at, items[-1].id) if len(rows) > limit else None)

    def delete(self, workspace: WorkspaceId, mesh_id: str) -> None:
        """Forget the mesh. Jobs that were accepted with it keep its bytes. Raises StateError `mesh.not_found`."""
        with self._db.session() as session:
            session.delete(_owned(session, workspace, mesh_id, lock=True))


def _owned(session: Session, workspace: WorkspaceId, mesh_id: str, *, lock: bool = False) -> MeshRow:
    row = session.scalars(_LOCKED if lock else _OWNED, {"mesh_id": mesh_id, "workspace": workspace}).one_or_none()
    if row is None:
        raise StateError("mesh.not_found", f"there is no mesh {mesh_id}", mesh=mesh_id)
    return row


def _record(row: MeshRow) -> MeshRecord:
    x, y, z = row.extents_mm
    return MeshRecord(
        id=row.id,
        name=row.name,
        file_name=row.file_name,
        unit=row.unit,
        format=row.format,
        size_bytes=row.size_bytes,
        sha256=row.sha256,
        canonical_sha256=row.canonical_sha256,
        vertices=row.vertices,
        faces=row.faces,
        extents_mm=(x, y, z),
        findings=tuple(row.findings),
        created_at=row.created_at,
        arrays=tuple(row.arrays or ()),
        volume=row.volume,
        field=row.field,
        coil=row.coil,
    )


def _stored(told: Mapping[str, Any] | None) -> dict[str, Any] | None:
    return None if told is None else storable(dict(told))


_OWNED = select(MeshRow).where(MeshRow.id == bindparam("mesh_id"), MeshRow.workspace == bindparam("workspace"))
_LOCKED = _OWNED.with_for_update()
