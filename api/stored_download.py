"""A blob as a download."""

from __future__ import annotations

from functools import partial

from api.downloads import Download, content_disposition
from store.blobs import Blobs


def stored_download(blobs: Blobs, sha256: str, size: int, *, file_name: str, media_type: str, inline: bool = False) -> Download:
    """Raises InternalError `blob.missing`: that it is there must be known before the answer begins."""
    blobs.open(sha256).close()
    # a page shown in place needs the headers we send with it
    link = None if inline else blobs.link(sha256, content_disposition(file_name), media_type)
    return Download(partial(blobs.read, sha256), size, sha256, media_type, file_name, inline, link)
