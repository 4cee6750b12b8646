"""A multipart upload, streamed to disk: at no time is more than a piece of the file in memory."""

from __future__ import annotations

import errno
import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, BinaryIO

from python_multipart import MultipartParser
from python_multipart.exceptions import FormParserError
from python_multipart.multipart import parse_options_header
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request

from api.request_body import RequestBody
from core.errors import InputError, LimitError

if TYPE_CHECKING:
    from python_multipart.multipart import MultipartCallbacks

MAX_FIELD_BYTES = 2000
FORM_BYTES = 64 * 1024  # room for the form around the file
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_FIELDS = ("unit", "name")
_FILE = "file"


@dataclass(frozen=True, slots=True)
class ReceivedFile:
    """The uploaded file on disk and the fields that came with it."""

    path: Path
    file_name: str
    size: int
    sha256: str
    fields: dict[str, str]


async def receive_file(
    request: Request, path: Path, limit_bytes: int, more_fields: Mapping[str, int] = MappingProxyType({})
) -> ReceivedFile:
    """Write the part `file` of a multipart body to `path`. more_fields: name -> longest, beside unit and name.

    Raises LimitError `upload.too_large`, InputError `request.media_type`, `request.malformed`, `upload.field_unknown`,
    `upload.file_missing`, `upload.interrupted`, LimitError `storage.full`."""
    media_type, options = parse_options_header(request.headers.get("content-type"))
    if media_type != b"multipart/form-data":
        sent = media_type.decode("latin-1")[:100] or "none"
        raise InputError("request.media_type", f"An upload is multipart/form-data with a part 'file'; it came as {sent}")
    body = RequestBody(request)
    declared = request.headers.get("content-length", "")
    if declared.isdecimal() and int(declared[:18]) > limit_bytes + FORM_BYTES:
        if "expect" not in request.headers:  # with 100-continue nothing is on its way yet
            await body.drain()
        raise _too_large(limit_bytes, f"the request has {declared[:18]}")
    try:
        with path.open("xb") as target:
            form = _Form(target, limit_bytes, {**dict.fromkeys(_FIELDS, MAX_FIELD_BYTES), **more_fields})
            parser = MultipartParser(options.get(b"boundary", b""), form.callbacks())
            async for piece in body.pieces():
                await run_in_threadpool(_parse, parser, piece)
            return form.result(path)
    except FormParserError as error:
        await body.drain()
        raise InputError("request.malformed", f"The multipart body cannot be read: {error}") from error
    except (InputError, LimitError):
        await body.drain()
        raise
    except OSError as error:
        if error.errno not in _NO_ROOM:
            raise
        await body.drain()
        raise LimitError("storage.full", f"The disk is full after {body.size} bytes of the upload", size=body.size) from error


def _parse(parser: MultipartParser, chunks: Iterable[bytes]) -> None:
    for chunk in chunks:
        parser.write(chunk)


def _too_large(limit_bytes: int, said: str) -> LimitError:
    return LimitError("upload.too_large", f"Uploads may have {limit_bytes} bytes at most; {said}", limit_bytes=limit_bytes)


@dataclass(slots=True)
class _Form:
    """Callbacks of the parser and what they have gathered."""

    target: BinaryIO
    limit_bytes: int
    known: Mapping[str, int]
    size: int = 0
    digest: hashlib._Hash = field(default_factory=hashlib.sha256)
    file_name: str | None = None
    fields: dict[str, str] = field(default_factory=dict)
    ended: bool = False
    _header_name: bytes = b""
    _header_value: bytes = b""
    _disposition: bytes = b""
    _part: str = ""
    _text: bytes = b""

    def callbacks(self) -> MultipartCallbacks:
        return {
            "on_part_begin": self._begin_part,
            "on_header_field": self._add_header_name,
            "on_header_value": self._add_header_value,
            "on_header_end": self._end_header,
            "on_headers_finished": self._start_part,
            "on_part_data": self._add_data,
            "on_part_end": self._end_part,
            "on_end": self._end,
        }

    def result(self, path: Path) -> ReceivedFile:
        if not self.ended:
            raise InputError("request.malformed", "The multipart body ends before its closing boundary")
        if self.file_name is None:
            raise InputError("upload.file_missing", "The form has no part named 'file' with a file name")
        return ReceivedFile(path, self.file_name, self.size, self.digest.hexdigest(), self.fields)

    def _begin_part(self) -> None:
        self._disposition = self._text = b""

    def _add_header_name(self, data: bytes, start: int, end: int) -> None:
        self._header_name += data[start:end]

    def _add_header_value(self, data: bytes, start: int, end: int) -> None:
        self._header_value += data[start:end]

    def _end_header(self) -> None:
        if self._header_name.lower() == b"content-disposition":
            self._disposition = self._header_value
        self._header_name = self._header_value = b""

    def _start_part(self) -> None:
        _, options = parse_options_header(self._disposition)
        self._part = _decoded(options.get(b"name", b""))
        if self._part not in (_FILE, *self.known):
            known = ", ".join((_FILE, *self.known))
            raise InputError("upload.field_unknown", f"The form has a part '{self._part[:100]}'; known are {known}")
        if self._part in self.fields or (self._part == _FILE and self.file_name is not None):
            raise InputError("upload.field_unknown", f"The form has two parts '{self._part}'; send one mesh per upload")
        if self._part == _FILE:
            if b"filename" not in options:
                raise InputError("upload.file_missing", "The part 'file' has no file name")
            self.file_name = plain_name(_decoded(options[b"filename"]))

    def _add_data(self, data: bytes, start: int, end: int) -> None:
        if self._part == _FILE:
            self.size += end - start
            if self.size > self.limit_bytes:
                raise _too_large(self.limit_bytes, "the file has more")
            piece = memoryview(data)[start:end]
            self.digest.update(piece)
            self.target.write(piece)
            return
        self._text += data[start:end]
        if len(self._text) > self.known[self._part]:
            raise InputError("upload.field_too_long", f"The field '{self._part}' has more than {self.known[self._part]} bytes")

    def _end_part(self) -> None:
        if self._part != _FILE:
            self.fields[self._part] = _decoded(self._text)

    def _end(self) -> None:
        self.ended = True


def _decoded(raw: bytes) -> str:
    return raw.decode("utf-8", errors="replace")


def plain_name(sent: str) -> str:
    """The last part of whatever path the client's system put there."""
    name = sent.replace("\\", "/").rsplit("/", 1)[-1]
    return "".join(character for character in name if character.isprintable())[-200:] or "upload"
