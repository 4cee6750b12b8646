"""Downloads that survive broken connections and never leave half a file under the target's name."""

from __future__ import annotations

from email.message import Message
from pathlib import Path, PurePosixPath

import httpx

from integument.digest import sha256_of_etag, stated_sha256
from integument.errors import DownloadCorruptError, ProblemError, ReplyError, ServerError
from integument.part_file import PartFile
from integument.transport import Transport
from integument.upload import OnBytes


def download(transport: Transport, path: str, target: Path, on_bytes: OnBytes | None = None) -> Path:
    """Fetch `path` into `target`, resuming what an earlier call left in `target.part`.

    The file appears under its name only when complete and, where the server states a SHA-256, equal to it.
    If bytes of an earlier call turn out bad, the download starts once more from nothing.

    Raises: DownloadCorruptError, ProblemError, ServerUnreachableError, OSError (no room, no permission).
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    part = PartFile(target)
    resumed = part.size() > 0
    expected = _fetch_patiently(transport, path, part, on_bytes)
    got = part.sha256()
    if expected not in (None, got) and resumed:
        part.discard()
        expected = _fetch_patiently(transport, path, part, on_bytes)
        got = part.sha256()
    if expected is not None and expected != got:
        part.discard()
        raise DownloadCorruptError(path, expected, got)
    part.finish()
    return target


def offered_file_name(transport: Transport, path: str) -> str:
    """The name the server gives the file, without any folder; the last part of `path` if it gives none, or refuses.

    A refusal of HEAD has no body: the GET that follows will say what is wrong.
    """
    header = Message()
    try:
        header["content-disposition"] = transport.request("HEAD", path).headers.get("content-disposition", "attachment")
    except ProblemError:
        return PurePosixPath(path).name
    name = PurePosixPath((header.get_filename() or "").replace("\\", "/")).name.lstrip(".")
    return name or PurePosixPath(path).name


def _fetch_patiently(transport: Transport, path: str, part: PartFile, on_bytes: OnBytes | None) -> str | None:
    backoff = transport.backoff()
    while True:
        before = part.size()
        try:
            return _fetch_rest(transport, path, part, on_bytes)
        except ServerError as error:
            if part.size() > before:
                backoff.reset()
            backoff.pause(error)


def _fetch_rest(transport: Transport, path: str, part: PartFile, on_bytes: OnBytes | None) -> str | None:
    """One connection; returns the SHA-256 the server states for the whole file."""
    etag = part.etag()
    if not etag:
        part.discard()
    have = part.size()
    headers = {"Accept": "*/*", "Accept-Encoding": "identity"}
    if have:
        headers |= {"Range": f"bytes={have}-", "If-Range": etag}
    with transport.stream("GET", path, headers=headers) as response:
        if response.status_code == httpx.codes.REQUESTED_RANGE_NOT_SATISFIABLE:
            if response.headers.get("content-range") == f"bytes */{have}":
                return stated_sha256(response.headers) or sha256_of_etag(etag)
            part.discard()
            return _fetch_rest(transport, path, part, on_bytes)
        if response.status_code == httpx.codes.PARTIAL_CONTENT:
            _require_continuation(response, have)
        else:
            part.restart(response.headers.get("etag", ""))
        _append(response, part, on_bytes)
        return stated_sha256(response.headers)


def _require_continuation(response: httpx.Response, have: int) -> None:
    content_range = response.headers.get("content-range", "")
    if not content_range.startswith(f"bytes {have}-"):
        raise ReplyError(f"asked for the bytes from {have}, the server sent '{content_range}'")


def _append(response: httpx.Response, part: PartFile, on_bytes: OnBytes | None) -> None:
    done = part.size()
    total = done + int(response.headers.get("content-length", 0))
    with part.path.open("ab") as file:
        for piece in response.iter_raw():
            file.write(piece)
            done += len(piece)
            if on_bytes is not None:
                on_bytes(done, total)
