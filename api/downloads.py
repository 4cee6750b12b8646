"""Files over HTTP: strong ETag, 304, one Range, If-Range, HEAD, Repr-Digest, and a safe file name (RFC 9110, 9530, 6266)."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from core.errors import StateError

CHUNK_BYTES = 256 * 1024
_RANGE = re.compile(r"bytes=\s*(\d{0,18})\s*-\s*(\d{0,18})\s*", re.IGNORECASE)
_SAFE_NAME = re.compile(r"[^A-Za-z0-9._-]+")
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f/\\]+|[\ud800-\udfff]+")


@dataclass(frozen=True, slots=True)
class Download:
    """A file that never changes: its sha256 (hex) names its bytes.

    read(start, stop): a half-open span of them in pieces. link: where to get them without us, or None."""

    read: Callable[[int, int], Iterator[bytes]]
    size: int
    sha256: str
    media_type: str
    file_name: str
    inline: bool = False
    link: str | None = None


def send_download(
    request: Request,
    download: Download,
    *,
    extra_headers: dict[str, str] | None = None,
) -> Response:
    """The answer to GET or HEAD. Several ranges in one request get the whole file, as RFC 9110 allows.

    Raises StateError `range.not_satisfiable` if the range starts behind the end."""
    etag = f'"{download.sha256}"'
    headers = {
        "ETag": etag,
        "Accept-Ranges": "bytes",
        "Cache-Control": "private, no-cache",
        "Content-Disposition": content_disposition(download.file_name, inline=download.inline),
        "Repr-Digest": f"sha-256=:{base64.b64encode(bytes.fromhex(download.sha256)).decode()}:",
        **(extra_headers or {}),
    }
    if _matches(request.headers.get("if-none-match"), etag):
        return Response(status_code=304, headers=headers)
    if download.link is not None and request.method == "GET":
        return Response(status_code=307, headers={"Location": download.link, "Cache-Control": "no-store"})
    span = None
    if request.headers.get("if-range", etag) == etag:
        span = requested_span(request.headers.get("range"), download.size)
    start, stop = span or (0, download.size)
    headers["Content-Length"] = str(stop - start)
    if span is not None:
        headers["Content-Range"] = f"bytes {start}-{stop - 1}/{download.size}"
    status = 206 if span is not None else 200
    if request.method == "HEAD":
        return Response(status_code=status, headers=headers, media_type=download.media_type)
    return StreamingResponse(
        download.read(start, stop),
        status_code=status,
        headers=headers,
        media_type=download.media_type,
    )


def requested_span(header: str | None, size: int) -> tuple[int, int] | None:
    """The half-open byte span a `Range` header asks for; None if it asks for none, for several, or in an unknown way."""
    match = _RANGE.fullmatch(header) if header is not None else None
    if match is None or match.group(1) == match.group(2) == "":
        return None
    first, last = match.groups()
    if first == "":
        start, stop = max(size - int(last), 0), size
    else:
        start, stop = int(first), min(int(last) + 1 if last else size, size)
        if last and int(last) < start:
            return None  # malformed, to be ignored
    if start >= size or start >= stop:
        raise StateError("range.not_satisfiable", f"{match[0].strip()} lies outside the {size} bytes of the file", size=size)
    return start, stop


def content_disposition(file_name: str, *, inline: bool = False) -> str:
    """`attachment` with an ASCII name for every client and the real one, percent-encoded, for those that can."""
    kind = "inline" if inline else "attachment"
    name = _CONTROL.sub("_", file_name).strip(". ")[:200] or "file"
    plain = _SAFE_NAME.sub("_", name).strip("._") or "file"
    extended = "" if plain == name else f"; filename*=UTF-8''{quote(name, safe='')}"
    return f'{kind}; filename="{plain}"{extended}'


def _matches(if_none_match: str | None, etag: str) -> bool:
    if if_none_match is None:
        return False
    tags = [tag.strip().removeprefix("W/") for tag in if_none_match.split(",")]
    return "*" in tags or etag in tags


def read_file(path: Path, start: int, stop: int) -> Iterator[bytes]:
    """A half-open span of a file, in pieces."""
    with path.open("rb") as file:
        file.seek(start)
        while start < stop:
            chunk = file.read(min(CHUNK_BYTES, stop - start))
            if not chunk:
                raise OSError(f"{path.name} is shorter than its record says")
            start += len(chunk)
            yield chunk
