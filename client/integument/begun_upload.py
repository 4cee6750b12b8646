"""Uploads in pieces (tus 1.0.0) that go on where the server stands, also in a later call."""

from __future__ import annotations

import base64
import hashlib
import json
import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from uuid import uuid4

from integument.answer import read_json
from integument.data_folder import default_data_dir
from integument.errors import ArgumentError, ServerError
from integument.transport import Transport
from integument.upload import CountedFile, Source

TUS = {"Tus-Resumable": "1.0.0"}
PIECE_BYTES = 16 * 1024**2


@dataclass(frozen=True, slots=True)
class BegunUpload:
    """`path` of the upload on the server; `key`, with which something is made of it once however often it is asked for."""

    path: str
    key: str

    @classmethod
    def begin(cls, transport: Transport, file: CountedFile, file_name: str, unit: str) -> BegunUpload:
        """Announce the file."""
        told = {"filename": file_name, "unit": unit}
        metadata = ",".join(f"{name} {base64.b64encode(value.encode()).decode()}" for name, value in told.items())
        headers = {**TUS, "Upload-Length": str(size_of(file)), "Upload-Metadata": metadata}
        return cls(transport.request("POST", "/v1/uploads", headers=headers).headers["Location"], str(uuid4()))

    def send_rest(self, transport: Transport, file: CountedFile) -> None:
        """What the server does not have yet, piece by piece. Raises ProblemError, `upload.not_found` among them."""
        size, received, backoff = size_of(file), -1, transport.backoff()
        while received < size:
            try:
                received = self._send_piece(transport, file)
                backoff.reset()
            except ServerError as error:
                backoff.pause(error)

    def _send_piece(self, transport: Transport, file: CountedFile) -> int:
        """Ask where the server stands, for a piece may have come only in part, and go on there."""
        offset = int(read_json(transport.attempt("GET", self.path))["received"])
        file.seek(offset)
        piece = file.read(PIECE_BYTES)
        if not piece:
            return offset
        headers = {**TUS, "Upload-Offset": str(offset), "Content-Type": "application/offset+octet-stream"}
        return int(transport.attempt("PATCH", self.path, headers=headers, content=piece).headers["Upload-Offset"])


@dataclass(frozen=True, slots=True)
class Memory:
    """Where a call notes which upload it began, for the call after it; None of files that have no path."""

    file: Path | None

    @classmethod
    def of(cls, source: Source, unit: str) -> Memory:
        """The same file, by place, size and time of its last change, in the same unit."""
        if not isinstance(source, str | os.PathLike):
            return cls(None)
        path = Path(source).absolute()
        try:
            stat = path.stat()
        except OSError as error:
            raise ArgumentError(f"cannot read {path}: {error.strerror or error}") from error
        told = json.dumps([str(path), stat.st_size, stat.st_mtime_ns, unit])
        return cls(default_data_dir() / "begun-uploads" / hashlib.sha256(told.encode()).hexdigest())

    def recall(self) -> BegunUpload | None:
        """What an earlier call began."""
        if self.file is None:
            return None
        try:
            told = json.loads(self.file.read_text(encoding="utf-8"))
            return BegunUpload(str(told["path"]), str(told["key"]))
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def keep(self, begun: BegunUpload) -> None:
        """Without a place to write to, a later call begins anew; this one is none the worse."""
        if self.file is not None:
            with suppress(OSError):
                self.file.parent.mkdir(parents=True, exist_ok=True)
                self.file.write_text(json.dumps({"path": begun.path, "key": begun.key}), encoding="utf-8")

    def forget(self) -> None:
        """It has come to its end."""
        if self.file is not None:
            with suppress(OSError):
                self.file.unlink(missing_ok=True)


def size_of(file: CountedFile) -> int:
    """In bytes; where it stands is not kept."""
    return file.seek(0, os.SEEK_END)
