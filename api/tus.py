"""The headers of tus 1.0.0, the protocol of resumable uploads (https://tus.io/protocols/resumable-upload)."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from email.utils import format_datetime
from typing import Annotated

from fastapi import Depends
from starlette.requests import Request

from core.errors import InputError

VERSION = "1.0.0"
EXTENSIONS = "creation,expiration,termination,checksum"
PATCH_MEDIA_TYPE = "application/offset+octet-stream"
ALGORITHMS: dict[str, Callable[[], hashlib._Hash]] = {"sha1": hashlib.sha1, "sha256": hashlib.sha256}
MAX_METADATA = 8000
HEADERS = {"Tus-Resumable": VERSION, "Cache-Control": "no-store"}


async def require_version(request: Request) -> None:
    """Raises InputError `upload.version` unless the request speaks this version."""
    spoken = request.headers.get("tus-resumable")
    if spoken != VERSION:
        raise InputError("upload.version", f"Tus-Resumable is {VERSION} here; the request says {(spoken or 'nothing')[:20]}")


Versioned = Depends(require_version)


def number_of(request: Request, header: str) -> int:
    """A header that is a whole number. Raises InputError `upload.header_invalid`."""
    sent = request.headers.get(header, "")
    if not (sent.isascii() and sent.isdecimal() and len(sent) <= 18):
        raise InputError("upload.header_invalid", f"{header} must be a whole number; it is {sent[:40]!r}", header=header)
    return int(sent)


def metadata_of(request: Request) -> Mapping[str, str]:
    """`Upload-Metadata`: names and Base64 values. Raises InputError `upload.header_invalid`."""
    sent = request.headers.get("upload-metadata", "")
    if len(sent) > MAX_METADATA:
        raise InputError("upload.header_invalid", f"Upload-Metadata has {len(sent)} characters, {MAX_METADATA} are taken")
    found = {}
    for entry in filter(None, (part.strip() for part in sent.split(","))):
        name, _, value = entry.partition(" ")
        try:
            found[name] = base64.b64decode(value.strip(), validate=True).decode("utf-8")
        except ValueError:  # no Base64, no ASCII, or no UTF-8 in it
            raise InputError(
                "upload.header_invalid", f"Upload-Metadata {name[:40]!r} is no Base64 of UTF-8", header="Upload-Metadata"
            ) from None
    return found


@dataclass(frozen=True, slots=True)
class Checksum:
    """What the bytes of one request must add up to."""

    algorithm: str
    expected: bytes

    def require(self, digest: hashlib._Hash) -> None:
        """Raises InputError `upload.checksum_mismatch`."""
        if digest.digest() != self.expected:
            raise InputError(
                "upload.checksum_mismatch",
                f"the {self.algorithm} of what arrived is {base64.b64encode(digest.digest()).decode()}; send it again",
            )

    def new_digest(self) -> hashlib._Hash:
        """Of no bytes yet."""
        return ALGORITHMS[self.algorithm]()


async def checksum_of(request: Request) -> Checksum | None:
    """`Upload-Checksum`, None without one. Raises InputError `upload.header_invalid`."""
    sent = request.headers.get("upload-checksum")
    if sent is None:
        return None
    algorithm, _, value = sent.strip().partition(" ")
    if algorithm not in ALGORITHMS:
        raise InputError("upload.header_invalid", f"Upload-Checksum names {algorithm[:20]!r}; known are {', '.join(ALGORITHMS)}")
    try:
        return Checksum(algorithm, base64.b64decode(value.strip(), validate=True))
    except ValueError:  # binascii.Error is one, and so is text that is no ASCII
        raise InputError("upload.header_invalid", "Upload-Checksum is no Base64") from None


def expires(moment: datetime) -> str:
    """As `Upload-Expires` writes it."""
    return format_datetime(moment, usegmt=True)


ChecksumDep = Annotated[Checksum | None, Depends(checksum_of)]
