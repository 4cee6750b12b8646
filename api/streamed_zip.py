"""A zip of stored files, made while it is sent: nothing of it is on disk or whole in memory."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import BinaryIO
from zipfile import ZIP_STORED, ZipFile, ZipInfo

CHUNK_BYTES = 256 * 1024
EARLIEST_DATE = (1980, 1, 1, 0, 0, 0)  # zip knows no earlier one: the same files give the same bytes
UNIX = 3
PLAIN_FILE = 0o100644


@dataclass(frozen=True, slots=True)
class StoredFile:
    """One file to be; `name` with `/` between folders."""

    name: str
    size: int
    open: Callable[[], AbstractContextManager[BinaryIO]]


class _Sink(io.RawIOBase):
    """What was written since the last look; it cannot be gone back in, so entries have their sizes behind them."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []

    def writable(self) -> bool:
        return True

    def write(self, data: object) -> int:
        piece = bytes(memoryview(data))  # type: ignore[arg-type]  # whatever has a buffer
        self._pieces.append(piece)
        return len(piece)

    def take(self) -> bytes:
        taken = b"".join(self._pieces)
        self._pieces.clear()
        return taken


def stream_zip(files: Iterable[StoredFile]) -> Iterator[bytes]:
    """The pieces of the zip. Not compressed: packages and STL in them are already, or hardly can be."""
    sink = _Sink()
    with ZipFile(sink, "w", ZIP_STORED) as archive:
        for file in files:
            entry = ZipInfo(file.name, EARLIEST_DATE)
            entry.create_system = UNIX
            entry.external_attr = PLAIN_FILE << 16
            entry.file_size = file.size  # tells whether it needs the larger form
            with file.open() as source, archive.open(entry, "w") as target:
                while piece := source.read(CHUNK_BYTES):
                    target.write(piece)
                    yield sink.take()
        yield sink.take()
    yield sink.take()
