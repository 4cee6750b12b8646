"""From a backup to a service: into an empty place, files first, so that no row ever names what is not there."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

from core.errors import InputError, InternalError, StateError
from store.backup.load import load_tables
from store.backup.manifest import Manifest
from store.backup.revive import revive
from store.backup.tables import EXPENDABLE, count_rows
from store.backup.vault import Vault
from store.blobs import CHUNK_BYTES, Blobs
from store.database import Database

MADE_BY_MIGRATIONS = {"workspaces": 1}  # rows of an empty database


@dataclass(frozen=True, slots=True)
class RestoreReport:
    """What came back. blobs: files that were put; those there already and whole were left."""

    name: str
    manifest: Manifest
    blobs: int
    queued_again: int


class Restore:
    """Into one database and its blobs. Nothing may run on them meanwhile."""

    def __init__(self, db: Database, blobs: Blobs, vault: Vault) -> None:
        self._db = db
        self._blobs = blobs
        self._vault = vault

    def restore(self, name: str) -> RestoreReport:
        """All of a backup; whatever breaks off in between, the same call may be made again.

        Raises InputError `backup.not_found`, `backup.too_new`, StateError `restore.not_empty`, InternalError `backup.corrupt`,
        LimitError `storage.full`."""
        manifest = self._vault.manifest(name)
        names = self._vault.blob_names(name)
        for table in manifest.tables.values():
            self._vault.require(name, table.file, table.sha256)
        if not self._db.knows(manifest.revision):
            raise InputError(
                "backup.too_new",
                f"backup {name} was made by version {manifest.version}, whose tables this one does not know",
                version=manifest.version,
                revision=manifest.revision,
            )
        self._require_empty()
        put = self.put_files(names)
        if manifest.revision != self._db.revision():
            self._db.revert("base")
            self._db.migrate(manifest.revision)
        with self._db.session() as session:
            load_tables(session, self._vault, name, manifest)
        self._db.migrate()
        return RestoreReport(name, manifest, put, revive(self._db))

    def put_files(self, names: Sequence[str]) -> int:
        """Those that are missing, or not what they are called; returns how many. Raises InternalError `backup.corrupt`."""
        put = 0
        for sha256 in names:
            if self._is_whole(sha256):
                continue
            self._blobs.delete(sha256)
            path = self._vault.pool.path(sha256)
            blob = self._blobs.put_file(path) if path.is_file() else None
            if blob is None or blob.sha256 != sha256:
                if blob is not None:
                    self._blobs.delete(blob.sha256)
                raise InternalError(
                    "backup.corrupt", f"file {sha256} of the backup is missing or not as it was written", sha256=sha256
                )
            put += 1
        return put

    def _is_whole(self, sha256: str) -> bool:
        if not self._blobs.touch(sha256):
            return False
        digest = hashlib.sha256()
        with self._blobs.open(sha256) as file:
            while chunk := file.read(CHUNK_BYTES):
                digest.update(chunk)
        return digest.hexdigest() == sha256

    def _require_empty(self) -> None:
        with self._db.reading() as session:
            counted = {table: rows for table, rows in count_rows(session).items() if table not in EXPENDABLE}
        found = {table: rows for table, rows in counted.items() if rows > MADE_BY_MIGRATIONS.get(table, 0)}
        if found:
            told = ", ".join(f"{rows} {table}" for table, rows in found.items())
            raise StateError("restore.not_empty", f"the database is not empty ({told}); restore into an empty one")
