"""What is left behind on this host and in the store: found, measured, removed. Safe beside a running service."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from api.partial_file import find_unknown_files, sweep_partial_files
from api.request_folder import LEFT_BEHIND_S, find_left_behind, sweep_incoming
from store.blobs import Blob, Blobs
from store.database import Database
from store.jobs import Jobs
from store.references import References
from store.settings import Settings
from store.sqlite_file import SqliteFile
from store.stale_rows import StaleRows
from store.uploads import Uploads
from worker.job_folder import find_job_folders, sweep_job_folders
from worker.reconciler import BLOB_GRACE_S


@dataclass(frozen=True, slots=True)
class Heap:
    """One kind of it; bytes None: rows are not measured."""

    kind: str
    count: int
    bytes: int | None


class Garbage:
    """Files and folders of other hosts are theirs: run it there, too."""

    def __init__(self, settings: Settings, db: Database, blobs: Blobs) -> None:
        self._settings = settings
        self._db = db
        self._blobs = blobs
        self._incoming = settings.data_dir / "incoming"
        self._uploads = settings.data_dir / "uploads"
        self._known = Uploads(db).known

    def find(self) -> tuple[Heap, ...]:
        """Without touching anything."""
        orphans = self._blobs.orphans(References(self._db).all(), BLOB_GRACE_S)
        return (
            _blob_heap(orphans),
            _file_heap("folders of ended attempts", find_job_folders(self._settings.scratch_dir, Jobs(self._db))),
            _file_heap("folders of broken requests", find_left_behind(self._incoming, LEFT_BEHIND_S)),
            _file_heap("pieces of forgotten uploads", find_unknown_files(self._uploads, self._known)),
            *(Heap(f"rows of {table}", count, None) for table, count in StaleRows(self._db, self._settings).count().items()),
            *self._spare(),
        )

    def remove(self) -> tuple[Heap, ...]:
        """All of it; what went."""
        rows = StaleRows(self._db, self._settings).sweep()  # before the files they name
        jobs = _file_heap("folders of ended attempts", found := find_job_folders(self._settings.scratch_dir, Jobs(self._db)))
        requests = _file_heap("folders of broken requests", find_left_behind(self._incoming, LEFT_BEHIND_S))
        pieces = _file_heap("pieces of forgotten uploads", find_unknown_files(self._uploads, self._known))
        if found:
            sweep_job_folders(self._settings.scratch_dir, Jobs(self._db))
        if requests.count:
            sweep_incoming(self._incoming, LEFT_BEHIND_S)
        sweep_partial_files(self._uploads, self._known)
        swept = self._blobs.sweep(References(self._db).all(), BLOB_GRACE_S)
        spare = self._spare()
        if self._db.is_sqlite:
            SqliteFile(self._db).give_back(60.0)
        return (
            _blob_heap(swept),
            jobs,
            requests,
            pieces,
            *(Heap(f"rows of {table}", count, None) for table, count in rows.items()),
            *spare,
        )

    def _spare(self) -> tuple[Heap, ...]:
        if not self._db.is_sqlite:
            return ()
        use = SqliteFile(self._db).measure()
        return (Heap("spare pages of the database", 0, use.spare_bytes), Heap("write-ahead log", 1, use.wal_bytes))


def _blob_heap(blobs: Iterable[Blob]) -> Heap:
    sizes = [blob.size for blob in blobs]
    return Heap("files no row names", len(sizes), sum(sizes))


def _file_heap(kind: str, paths: list[Path]) -> Heap:
    return Heap(kind, len(paths), sum(map(_size, paths)))


def _size(path: Path) -> int:
    """Of a file, or of all files in a folder; what vanishes under our eyes counts for nothing."""
    total = 0
    for inside in (path, *(path.rglob("*") if path.is_dir() else ())):
        try:
            total += 0 if inside.is_dir() else inside.lstat().st_size
        except FileNotFoundError:
            continue
    return total
