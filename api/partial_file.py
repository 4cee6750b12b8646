"""The file of an upload in pieces. Its row says how many bytes count; what lies behind them was never acknowledged."""

from __future__ import annotations

import errno
import fcntl
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from core.errors import LimitError, StateError

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class PartialFile:
    """Locked for one request; the kernel lets go of the lock when the process dies, however it does."""

    def __init__(self, handle: int, path: Path) -> None:
        self._handle = handle
        self.path = path
        self.size = 0

    @property
    def present(self) -> int:
        """Bytes in it, whether they count or not."""
        return os.fstat(self._handle).st_size

    def cut(self, size: int) -> None:
        """Forget what is behind the bytes that count, and go on there."""
        os.ftruncate(self._handle, size)
        self.size = size

    def append(self, chunks: Sequence[bytes]) -> None:
        """Raises LimitError `storage.full`."""
        self.size = write_at(self._handle, chunks, self.size)

    def sync(self) -> None:
        """Only after this may anybody be told that the bytes are here."""
        os.fdatasync(self._handle)


def write_at(handle: int, chunks: Sequence[bytes], place: int) -> int:
    """All of them, one behind the other, into an open file; returns where they end. Raises LimitError `storage.full`."""
    left: Sequence[bytes | memoryview] = chunks
    end = place + sum(map(len, chunks))
    try:
        while place < end:
            written = os.pwritev(handle, left, place)
            place += written
            if place < end:
                left = [memoryview(b"".join(left))[written:]]
        return end
    except OSError as error:
        if error.errno in _NO_ROOM:
            raise LimitError("storage.full", f"The disk is full after {place} bytes of the upload") from error
        raise


@contextmanager
def partial_file(folder: Path, upload_id: str) -> Iterator[PartialFile]:
    """Raises StateError `upload.busy` if another request has it."""
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    path = folder / upload_id
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StateError("upload.busy", "another request is writing to this upload", upload=upload_id) from None
        yield PartialFile(handle, path)
    finally:
        os.close(handle)


def sweep_partial_files(folder: Path, known: Callable[[], frozenset[str]]) -> int:
    """Remove the files of uploads that no row tells of; returns how many."""
    unwanted = find_unknown_files(folder, known)
    for path in unwanted:
        path.unlink(missing_ok=True)
    return len(unwanted)


def find_unknown_files(folder: Path, known: Callable[[], frozenset[str]]) -> list[Path]:
    """The files of uploads that no row tells of."""
    there = list(folder.iterdir()) if folder.is_dir() else []  # before the rows: a file never comes before its row
    wanted = known() if there else frozenset()
    return [path for path in there if path.name not in wanted]
