"""Content-addressed files on local disk: a name is the SHA-256 of its bytes, and a file that is there is whole.

Written beside its place, flushed to the disk, then renamed: a crash at any step leaves the old state or the new one."""

from __future__ import annotations

import errno
import fcntl
import hashlib
import io
import os
import re
import stat
import tempfile
import time
from collections.abc import Callable, Container, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import BinaryIO

from core.errors import InternalError, LimitError

CHUNK_BYTES = 1024 * 1024
_DIGEST = re.compile(r"[0-9a-f]{64}\Z")
_DISK_FULL = (errno.ENOSPC, errno.EDQUOT)


@dataclass(frozen=True, slots=True)
class Blob:
    """Stored bytes."""

    sha256: str
    size: int


class Blobs:
    """Layout: `ab/cd/abcd….` below the root, `.incoming/` for files being written. Safe for many processes on one disk."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._incoming = root / ".incoming"
        self._incoming.mkdir(parents=True, exist_ok=True, mode=0o700)
        self._lock_path = root / ".lock"

    def put_file(self, path: Path) -> Blob:
        """Copy a regular file in. A child process may have made it: links are not followed and a pipe does not make us wait.

        Raises LimitError `storage.full`, InternalError `blob.not_a_file`, OSError if it cannot be read."""
        try:
            handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
        except OSError as error:
            if error.errno in (errno.ELOOP, errno.ENXIO):
                raise InternalError("blob.not_a_file", f"{path.name} is not a regular file") from error
            raise
        try:
            if not stat.S_ISREG(os.fstat(handle).st_mode):
                raise InternalError("blob.not_a_file", f"{path.name} is not a regular file")
            return self._put(partial(os.read, handle))
        finally:
            os.close(handle)

    def put_bytes(self, data: bytes) -> Blob:
        """Store bytes. Raises LimitError `storage.full`."""
        return self._put(io.BytesIO(data).read)

    def _put(self, read: Callable[[int], bytes]) -> Blob:
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
        if not _DIGEST.match(sha256):
            raise InternalError("blob.bad_digest", f"{sha256!r} is no SHA-256 in hexadecimal")
        return self._root / sha256[:2] / sha256[2:4] / sha256

    def open(self, sha256: str) -> BinaryIO:
        """Raises InternalError `blob.missing`."""
        try:
            return self.path(sha256).open("rb")
        except FileNotFoundError:
            raise InternalError("blob.missing", f"blob {sha256} is not in the store", sha256=sha256) from None

    def touch(self, sha256: str) -> bool:
        """Make a blob young, so no sweep takes it before a row refers to it; False if it is not there."""
        with self._locked(fcntl.LOCK_SH):
            try:
                os.utime(self.path(sha256))
            except FileNotFoundError:
                return False
            return True

    def delete(self, sha256: str) -> bool:
        """Remove a blob nothing refers to; False if it was not there."""
        try:
            self.path(sha256).unlink()
        except FileNotFoundError:
            return False
        return True

    def all(self) -> Iterator[Blob]:
        """All blobs, in no order."""
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

    def sweep(self, referenced: Container[str], older_than_s: float) -> list[Blob]:
        """Delete blobs that are not `referenced`, and remains of interrupted writes, if older than that; returns what went.

        Safe beside writers: putting or touching a blob makes it young, so `older_than_s` must exceed the time from that to its
        row, and `referenced` must have been read after everything older had its row."""
        before = time.time() - older_than_s
        swept = []
        with self._locked(fcntl.LOCK_EX):
            for blob in self.all():
                path = self.path(blob.sha256)
                if blob.sha256 not in referenced and path.stat().st_mtime < before:
                    path.unlink()
                    swept.append(blob)
        for remains in self._incoming.iterdir():
            with suppress(FileNotFoundError):  # its writer has just finished
                if remains.stat().st_mtime < before:
                    remains.unlink()
        return swept


def _sync_folder(folder: Path) -> None:
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
