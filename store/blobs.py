"""Content-addressed files: a name is the SHA-256 of its bytes, and a file that is there is whole."""

from __future__ import annotations

import re
from collections.abc import Container, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol

from core.errors import InternalError

CHUNK_BYTES = 1024 * 1024
_DIGEST = re.compile(r"[0-9a-f]{64}\Z")


@dataclass(frozen=True, slots=True)
class Blob:
    """Stored bytes."""

    sha256: str
    size: int


class Blobs(Protocol):
    """Where the bytes are kept: a folder or an object store. Safe for any number of processes and hosts.

    Every method may raise InternalError `blobs.unavailable` if the store does not answer; a later attempt may succeed.
    """

    def put_file(self, path: Path) -> Blob:
        """Copy a regular file in. A child process may have made it: links are not followed and a pipe does not make us wait.

        Raises LimitError `storage.full`, InternalError `blob.not_a_file`, OSError if it cannot be read."""
        ...

    def put_open(self, file: BinaryIO) -> Blob:
        """Copy a file of our own in, all of it. Raises LimitError `storage.full`."""
        ...

    def put_bytes(self, data: bytes) -> Blob:
        """Store bytes. Raises LimitError `storage.full`."""
        ...

    def open(self, sha256: str) -> BinaryIO:
        """The bytes, to be read from the start. Raises InternalError `blob.missing`."""
        ...

    def read(self, sha256: str, start: int, stop: int) -> Iterator[bytes]:
        """A half-open span of the bytes in pieces. Raises InternalError `blob.missing`, also if the blob is shorter."""
        ...

    def fetch(self, sha256: str, folder: Path) -> Path:
        """A local file with these bytes, for a child to read: the store's own or a copy in `folder`, checked by its digest.

        Raises InternalError `blob.missing`, `blob.corrupt`; LimitError `storage.full`."""
        ...

    def link(self, sha256: str, disposition: str, media_type: str) -> str | None:
        """A URL that serves the bytes for a short while, with this Content-Disposition; None where there is none."""
        ...

    def touch(self, sha256: str) -> bool:
        """Make a blob young, so no sweep takes it before a row refers to it; False if it is not there."""
        ...

    def delete(self, sha256: str) -> bool:
        """Remove a blob nothing refers to; False if it was not there."""
        ...

    def all(self) -> Iterator[Blob]:
        """All blobs, in no order."""
        ...

    def orphans(self, referenced: Container[str], older_than_s: float) -> list[Blob]:
        """The blobs that `sweep` would delete now."""
        ...

    def sweep(self, referenced: Container[str], older_than_s: float) -> list[Blob]:
        """Delete blobs that are not `referenced`, and remains of interrupted writes, if older than that; returns what went.

        Safe beside writers: putting or touching a blob makes it young, so `older_than_s` must exceed the time from that to its
        row, and `referenced` must have been read after everything older had its row."""
        ...

    def check(self) -> None:
        """Returns if bytes can be stored now. Raises InternalError `blobs.unavailable`, LimitError `storage.full`."""
        ...


def require_digest(sha256: str) -> str:
    """The name, if it is one. Raises InternalError `blob.bad_digest`."""
    if not _DIGEST.match(sha256):
        raise InternalError("blob.bad_digest", f"{sha256!r} is no SHA-256 in hexadecimal")
    return sha256


def is_missing(sha256: str) -> InternalError:
    """The failure that tells of a blob nobody can find."""
    return InternalError("blob.missing", f"blob {sha256} is not in the store", sha256=sha256)


def is_corrupt(sha256: str) -> InternalError:
    """The failure that tells of a blob that is not what its name says."""
    return InternalError("blob.corrupt", f"the object store holds other bytes as blob {sha256}", sha256=sha256)
