"""Blobs in a folder.

Written beside its place, flushed to the disk, then renamed: a crash at any step leaves the old state or the new one."""

from __future__ import annotations

import errno
import fcntl
import hashlib
import io
import os
import tempfile
from collections.abc import Callable, Container, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from core.errors import LimitError
from store.blobs import CHUNK_BYTES, Blob, is_missing, require_digest
from store.regular_file import open_regular_file

_DISK_FULL = (errno.ENOSPC, errno.EDQUOT)


class LocalBlobs:
    """Layout: `ab/cd/abcd….` below the root, `.incoming/` for files being written. Safe for many processes on one disk."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._incoming = root / ".incoming"
        self._incoming.mkdir(parents=True, exist_ok=True, mode=0o700)
        self._lock_path = root / ".lock"

    def put_file(self, path: Path) -> Blob:
        """As `Blobs` says."""
        with open_regular_file(path) as file:
            return self.put_stream(file.read)

    def put_open(self, file: BinaryIO) -> Blob:
        """As `Blobs` says."""
        file.seek(0)
        return self.put_stream(file.read)

    def put_bytes(self, data: bytes) -> Blob:
        """As `Blobs` says."""
        return self.put_stream(io.BytesIO(data).read)

    def put_stream(self, read: Callable[[int], bytes]) -> Blob:
        """What `read` gives, piece by piece. Raises LimitError `storage.full`."""
        digest, size = hashlib.sha256(), 0
        try:
            handle, name = tempfile.mkstemp(dir=self._incoming)
            try:
                with os.fdopen(handle, "wb") as target:
                    while chunk := read(CHUNK_BYTES):
                        digest.update(chunk)
                        size += target.write(chunk)
                    target.flush()
                    blob = Blob(digest.hexdigest(), size)
                    if not self._has(blob):
                        os.fchmod(handle, 0o440)
                        os.fsync(handle)
                        self._place(Path(name), blob)
            finally:
                Path(name).unlink(missing_ok=True)
        except OSError as error:
            if error.errno in _DISK_FULL:
                raise LimitError("storage.full", f"the disk is full, {size} bytes were written", written_bytes=size) from error
            raise
        return blob

    def _has(self, blob: Blob) -> bool:
        """True if it is there; then it is made young, as by `touch`."""
        try:
            return self.path(blob.sha256).stat().st_size == blob.size and self.touch(blob.sha256)
        except FileNotFoundError:
            return False

    def _place(self, temporary: Path, blob: Blob) -> None:
        place = self.path(blob.sha256)
        with self._locked(fcntl.LOCK_SH):  # or a sweep that judged the file in this place would take the new one
            place.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            temporary.rename(place)
            for folder in (place.parent, place.parent.parent, self._root):
                _sync_folder(folder)

    def path(self, sha256: str) -> Path:
        """Where the blob is, if it is there. Read only."""
        require_digest(sha256)
        return self._root / sha256[:2] / sha256[2:4] / sha256

    def open(self, sha256: str) -> BinaryIO:
        """As `Blobs` says."""
        try:
            return self.path(sha256).open("rb")
        except FileNotFoundError:
            raise is_missing(sha256) from None

    def read(self, sha256: str, start: int, stop: int) -> Iterator[bytes]:
        """As `Blobs` says."""
        with self.open(sha256) as file:
            file.seek(start)
            while start < stop:
                chunk = file.read(min(CHUNK_BYTES, stop - start))
                if not chunk:
                    raise is_missing(sha256)
                start += len(chunk)
                yield chunk

    def fetch(self, sha256: str, folder: Path) -> Path:
        """The file itself: a child may read it where it is."""
        del folder
        self.open(sha256).close()
        return self.path(sha256)

    def link(self, sha256: str, disposition: str, media_type: str) -> str | None:
        """Nobody else serves a folder."""
        del sha256, disposition, media_type
        return None

    def touch(self, sha256: str) -> bool:
        """As `Blobs` says."""
        with self._locked(fcntl.LOCK_SH):
            try:
                os.utime(self.path(sha256))
            except FileNotFoundError:
                return False
            return True

    def delete(self, sha256: str) -> bool:
        """As `Blobs` says."""
        try:
            self.path(sha256).unlink()
        except FileNotFoundError:
            return False
        return True

    def all(self) -> Iterator[Blob]:
        """As `Blobs` says."""
        for path in self._root.glob("[0-9a-f][0-9a-f]/[0-9a-f][0-9a-f]/*"):
            yield Blob(path.name, path.stat().st_size)

    @contextmanager
    def _locked(self, kind: int) -> Iterator[None]:
        handle = os.open(self._lock_path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(handle, kind)
            yield
        finally:
            os.close(handle)

    def orphans(self, referenced: Container[str], older_than_s: float) -> list[Blob]:
        """As `Blobs` says."""
        before = self._now() - older_than_s
        return [blob for blob in self.all() if blob.sha256 not in referenced and self._is_older(blob, before)]

    def _is_older(self, blob: Blob, before: float) -> bool:
        try:
            return self.path(blob.sha256).stat().st_mtime < before
        except FileNotFoundError:
            return False

    def sweep(self, referenced: Container[str], older_than_s: float) -> list[Blob]:
        """As `Blobs` says."""
        before = self._now() - older_than_s
        with self._locked(fcntl.LOCK_EX):
            swept = [
                blob
                for blob in self.all()
                if blob.sha256 not in referenced and self._is_older(blob, before) and self.delete(blob.sha256)
            ]
        for remains in self._incoming.iterdir():
            with suppress(FileNotFoundError):  # its writer has just finished
                if remains.stat().st_mtime < before:
                    remains.unlink()
        return swept

    def _now(self) -> float:
        """By the clock that stamps the files: that of this process may be off, or another host's."""
        with tempfile.TemporaryFile(dir=self._incoming) as probe:
            return os.fstat(probe.fileno()).st_mtime

    def check(self) -> None:
        """As `Blobs` says: a file is written and taken away again."""
        with tempfile.TemporaryFile(dir=self._incoming) as probe:
            probe.write(b"ready")


def _sync_folder(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
