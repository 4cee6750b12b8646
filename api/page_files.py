"""The files of the web page as they are sent: read once, small enough to stay in memory, packed for those who can unpack."""

from __future__ import annotations

import gzip
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).resolve().parent / "static"  # where web/ is built to
INDEX = "index.html"
ASSETS = "assets"
MEDIA_TYPES = {
    ".css": "text/css; charset=utf-8",
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".png": "image/png",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
    ".woff2": "font/woff2",
}
PACKED_ALREADY = frozenset({".png", ".woff2"})


@dataclass(frozen=True, slots=True)
class PageFile:
    """One file; `packed` is the same in gzip, or None where that would not help."""

    content: bytes
    packed: bytes | None
    media_type: str
    etag: str

    @classmethod
    def read(cls, path: Path) -> PageFile:
        """Raises KeyError for a kind of file the page has no use for."""
        content = path.read_bytes()
        packed = None if path.suffix in PACKED_ALREADY else gzip.compress(content, 9, mtime=0)
        return cls(content, packed, MEDIA_TYPES[path.suffix], f'"{hashlib.sha256(content).hexdigest()[:32]}"')


def read_page(folder: Path = FOLDER) -> Mapping[str, PageFile]:
    """Path below the server's root -> file: `/` and `/assets/*`. Empty if the page was not built."""
    if not (folder / INDEX).exists():
        return {}
    assets = sorted(path for path in (folder / ASSETS).iterdir() if path.suffix in MEDIA_TYPES)
    return {"/": PageFile.read(folder / INDEX), **{f"/{ASSETS}/{path.name}": PageFile.read(path) for path in assets}}
