"""Makes a backup beside a running service: rows first, as of one moment, then the files those rows name."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from core.errors import IntegumentError
from store.backup.dump import dump_tables
from store.backup.manifest import BlobList, Manifest, TableFile
from store.backup.vault import Vault, digest_of, told, write_synced
from store.blobs import Blobs
from store.database import Database
from store.references import References

SNAPSHOTS = 3
TOUCH_AGAIN_S = 1200.0  # sweeps spare a touched blob for an hour
BLOB_LIST = "blobs.txt"


@dataclass(frozen=True, slots=True)
class BackupReport:
    """What was made. copied: files the pool did not hold yet."""

    name: str
    manifest: Manifest
    copied: int
    copied_bytes: int


class Backup:
    """Of one database and its blobs, into a vault."""

    def __init__(self, db: Database, blobs: Blobs, vault: Vault, version: str) -> None:
        self._db = db
        self._blobs = blobs
        self._vault = vault
        self._version = version
        self._touched_at = 0.0

    def make(self) -> BackupReport:
        """Whole, or not there.

        Raises StateError `backup.busy`, LimitError `storage.full`, InputError `backup.folder_unusable`."""
        with self._vault.alone(), told(self._vault.folder):
            with self._db.reading() as session:
                moment = self._db.now(session)
            with self._vault.draft(moment) as (draft, seal):
                tables, wanted, missing = self._snapshot(draft)
                new = [name for name in wanted if name not in missing and not self._is_kept(name)]
                corrupt = self._copy(new)
                kept = [name for name in wanted if name not in missing and name not in corrupt]
                manifest = Manifest(
                    version=self._version,
                    revision=self._db.revision(),
                    created_at=moment,
                    tables=tables,
                    blobs=self._list(kept, draft / BLOB_LIST),
                    missing=missing,
                    corrupt=corrupt,
                )
                name = seal(manifest)
            copied = [name for name in new if name not in corrupt]
            return BackupReport(name, manifest, len(copied), sum(self._size(name) for name in copied))

    def _snapshot(self, draft: Path) -> tuple[dict[str, TableFile], Sequence[str], tuple[str, ...]]:
        """The tables, the blobs they name, and those of them that are not in the store.

        A blob may go with its row between snapshot and touch; one that is missing after a later snapshot, too, is lost."""
        suspects: tuple[str, ...] = ()
        for _ in range(SNAPSHOTS):
            with self._db.snapshot() as session:
                tables = dump_tables(session, draft)
                wanted = sorted(References(self._db).seen_by(session))
            missing = self._protect([name for name in wanted if not self._is_kept(name)])
            if set(missing) <= set(suspects):
                break
            suspects = missing
        return tables, wanted, missing

    def _protect(self, names: Sequence[str]) -> tuple[str, ...]:
        """Make them young, so that no sweep takes them; returns those that are not there."""
        self._touched_at = time.monotonic()
        return tuple(name for name in names if not self._blobs.touch(name))

    def _copy(self, names: Sequence[str]) -> tuple[str, ...]:
        """Into the pool; returns those that are not what they are called."""
        corrupt = []
        for number, name in enumerate(names):
            if time.monotonic() - self._touched_at > TOUCH_AGAIN_S:
                self._protect(names[number:])
            with self._blobs.open(name) as source:
                blob = self._vault.pool.put_stream(source.read)
            if blob.sha256 != name:
                self._vault.pool.delete(blob.sha256)
                corrupt.append(name)
        return tuple(corrupt)

    def _is_kept(self, name: str) -> bool:
        return self._vault.pool.path(name).is_file()

    def _size(self, name: str) -> int:
        return self._vault.pool.path(name).stat().st_size

    def _list(self, names: Sequence[str], path: Path) -> BlobList:
        sizes = {name: self._size(name) for name in names}
        write_synced(path, "".join(f"{name} {size}\n" for name, size in sizes.items()).encode())
        return BlobList(file=path.name, count=len(sizes), bytes=sum(sizes.values()), sha256=digest_of(path))


def verify(vault: Vault, name: str, tell: Callable[[str], None]) -> bool:
    """Read every byte of a backup; False, and each fault told, if it is not as it was written."""
    faults = []
    try:
        manifest = vault.manifest(name)
        names = vault.blob_names(name)
        for table in manifest.tables.values():
            vault.require(name, table.file, table.sha256)
    except IntegumentError as error:
        tell(f"{error.message} [{error.code}]")
        return False
    for sha256 in names:
        path = vault.pool.path(sha256)
        if not path.is_file() or digest_of(path) != sha256:
            faults.append(sha256)
            tell(f"file {sha256} is missing or not as it was written")
    return not faults
