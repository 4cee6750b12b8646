"""The bytes of an upload: read from disk piece by piece, told to whoever draws the bar."""

from __future__ import annotations

import io
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from integument.errors import ArgumentError

Source = str | os.PathLike[str] | bytes | BinaryIO
OnBytes = Callable[[int, int], None]
"""(bytes done, bytes in all); starts again from 0 when the transfer does."""


class CountedFile:
    """A rewindable binary file whose reads are counted."""

    def __init__(self, file: BinaryIO, on_bytes: OnBytes | None) -> None:
        self._file = file
        self._on_bytes = on_bytes
        self._start = file.tell()
        self._size = file.seek(0, os.SEEK_END) - self._start
        file.seek(self._start)

    def read(self, size: int = -1) -> bytes:
        """The next bytes."""
        chunk = self._file.read(size)
        if self._on_bytes is not None and chunk:
            self._on_bytes(self.tell(), self._size)
        return chunk

    def tell(self) -> int:
        """Bytes read, counted from where the file stood when it was handed in."""
        return self._file.tell() - self._start

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Go back for another try, or to the end to learn the length."""
        target = self._start + offset if whence == os.SEEK_SET else offset
        return self._file.seek(target, whence) - self._start

    def __iter__(self) -> Iterator[bytes]:
        return iter(lambda: self.read(io.DEFAULT_BUFFER_SIZE), b"")


@contextmanager
def opened(source: Source, on_bytes: OnBytes | None) -> Iterator[tuple[CountedFile, str]]:
    """The source as a counted file, and a file name for it.

    Raises: ArgumentError if the file cannot be read or an open file cannot be rewound (a retry needs that).
    """
    if isinstance(source, bytes):
        yield CountedFile(io.BytesIO(source), on_bytes), "upload"
        return
    if isinstance(source, str | os.PathLike):
        path = Path(source)
        try:
            file = path.open("rb")
        except OSError as error:
            raise ArgumentError(f"cannot read {path}: {error.strerror or error}") from error
        with file:
            yield CountedFile(file, on_bytes), path.name
        return
    if not source.seekable():
        raise ArgumentError("an open file must be seekable, so that a broken upload can start again; hand in its bytes instead")
    yield CountedFile(source, on_bytes), Path(str(getattr(source, "name", "upload"))).name
