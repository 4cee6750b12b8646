"""The folder backups are kept in: one folder each, and a pool of files that all of them share.

2026-11-22T053000Z/manifest.json    a whole backup; before it is whole its name begins with a dot
2026-11-22T053000Z/jobs.jsonl.gz    rows
blobs/ab/cd/abcd...                 the pool: what an earlier backup holds is not copied again
"""

from __future__ import annotations

import errno
import fcntl
import hashlib
import os
import re
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

from pydantic import ValidationError

from core.errors import InputError, InternalError, LimitError, StateError
from store.backup.manifest import Manifest
from store.local_blobs import LocalBlobs

MANIFEST = "manifest.json"
_NAME = re.compile(r"\d{4}-\d\d-\d\dT\d{6}Z(-\d+)?")


class Vault:
    """Made if it is not there, readable by its owner alone: rows and files are those of all users."""

    def __init__(self, folder: Path) -> None:
        """Raises InputError `backup.folder_unusable`."""
        self.folder = folder.absolute()
        with told(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            (self.folder / "blobs").mkdir(exist_ok=True, mode=0o700)
            self.pool = LocalBlobs(self.folder / "blobs")

    def names(self) -> Sequence[str]:
        """The whole backups, the newest first."""
        return sorted(
            (path.parent.name for path in self.folder.glob(f"*/{MANIFEST}") if _NAME.fullmatch(path.parent.name)), reverse=True
        )

    def path(self, name: str) -> Path:
        """The folder of a whole backup. Raises InputError `backup.not_found`."""
        if name not in self.names():
            raise InputError("backup.not_found", f"there is no whole backup {name[:80]} in {self.folder}", backup=name[:80])
        return self.folder / name

    def manifest(self, name: str) -> Manifest:
        """Raises InputError `backup.not_found`, InternalError `backup.corrupt`."""
        try:
            return Manifest.model_validate_json((self.path(name) / MANIFEST).read_bytes())
        except ValidationError as error:
            raise InternalError(
                "backup.corrupt", f"the manifest of backup {name} cannot be read: {error.errors()[0]['msg']}"
            ) from None

    def blob_names(self, name: str) -> Sequence[str]:
        """The files of a backup, by digest. Raises as `manifest`."""
        told_of = self.manifest(name).blobs
        return [line.split(" ")[0] for line in self.read(name, told_of.file, told_of.sha256).decode().splitlines()]

    def read(self, name: str, file: str, sha256: str) -> bytes:
        """A small file of a backup, proven. Raises InternalError `backup.corrupt`."""
        self.require(name, file, sha256)
        return (self.path(name) / file).read_bytes()

    def require(self, name: str, file: str, sha256: str) -> Path:
        """A file of a backup that is as it was written. Raises InternalError `backup.corrupt`."""
        path = self.path(name) / file
        if not path.is_file() or digest_of(path) != sha256:
            raise InternalError("backup.corrupt", f"{file} of backup {name} is not as it was written", backup=name, file=file)
        return path

    @contextmanager
    def alone(self) -> Iterator[None]:
        """One writer at a time. Raises StateError `backup.busy`."""
        handle = os.open(self.folder / ".lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        except BlockingIOError:
            raise StateError("backup.busy", f"another backup is being written to {self.folder}") from None
        finally:
            os.close(handle)

    @contextmanager
    def draft(self, moment: datetime) -> Iterator[tuple[Path, Callable[[Manifest], str]]]:
        """A folder to write into, and what makes it a backup under its final name; without that it goes again.

        Remains of writers that were killed go as well. Hold `alone`."""
        for remains in self.folder.glob(".draft-*"):
            shutil.rmtree(remains)
        name = self._free_name(f"{moment:%Y-%m-%dT%H%M%SZ}")
        draft = self.folder / f".draft-{name}"
        draft.mkdir(mode=0o700)

        def seal(manifest: Manifest) -> str:
            write_synced(draft / MANIFEST, manifest.model_dump_json(indent=2).encode() + b"\n")
            sync_folder(draft)
            draft.rename(self.folder / name)
            sync_folder(self.folder)
            return name

        try:
            yield draft, seal
        finally:
            shutil.rmtree(draft, ignore_errors=True)

    def keep(self, number: int) -> Sequence[str]:
        """Remove all but the newest, and the files no other has; returns the names of those that went. Hold `alone`."""
        gone = self.names()[number:]
        for name in gone:
            doomed = self.folder / f".draft-{name}"  # from now on it is none, however far its removal comes
            (self.folder / name).rename(doomed)
            shutil.rmtree(doomed)
        if gone:
            wanted = {sha256 for name in self.names() for sha256 in self.blob_names(name)}
            for blob in list(self.pool.all()):
                if blob.sha256 not in wanted:
                    self.pool.delete(blob.sha256)
        return gone

    def _free_name(self, stem: str) -> str:
        taken = self.names()
        names = (stem, *(f"{stem}-{number}" for number in range(2, len(taken) + 3)))
        return next(name for name in names if name not in taken)


def digest_of(path: Path) -> str:
    """SHA-256 in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def write_synced(path: Path, content: bytes) -> None:
    """On the disk when this returns."""
    handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o600)
    with os.fdopen(handle, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(handle)


def sync_folder(folder: Path) -> None:
    """Its names are on the disk when this returns."""
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextmanager
def told(folder: Path) -> Iterator[None]:
    """The words of the operating system become ours. Raises LimitError `storage.full`, InputError `backup.folder_unusable`."""
    try:
        yield
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise LimitError("storage.full", f"the disk of the backup {folder} is full") from error
        raise InputError("backup.folder_unusable", f"{folder} cannot be used: {error.strerror}", folder=str(folder)) from error
