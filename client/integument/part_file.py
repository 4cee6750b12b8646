"""A download that is not complete yet: `name.part`, and beside it the ETag it belongs to."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

HASH_PIECE_BYTES = 1 << 20


@dataclass(frozen=True, slots=True)
class PartFile:
    """What has arrived of `target` so far, kept between calls so that a broken download goes on where it stopped."""

    target: Path

    @property
    def path(self) -> Path:
        """Where the bytes are collected."""
        return self.target.with_name(self.target.name + ".part")

    @property
    def _etag_path(self) -> Path:
        return self.target.with_name(self.target.name + ".part.etag")

    def size(self) -> int:
        """Bytes that have arrived."""
        return self.path.stat().st_size if self.path.exists() else 0

    def etag(self) -> str:
        """The version these bytes belong to; empty if unknown, then they are worth nothing."""
        return self._etag_path.read_text(encoding="ascii").strip() if self._etag_path.exists() else ""

    def restart(self, etag: str) -> None:
        """Forget all bytes; the next ones belong to `etag`. Weak ETags cannot be resumed (RFC 9110, 13.1.5) and are not kept."""
        self.discard()
        if etag.startswith('"'):
            self._etag_path.write_text(etag, encoding="ascii")

    def discard(self) -> None:
        """Leave nothing behind."""
        self.path.unlink(missing_ok=True)
        self._etag_path.unlink(missing_ok=True)

    def sha256(self) -> str:
        """Hex digest of what is on disk."""
        digest = hashlib.sha256()
        with self.path.open("rb") as file:
            while piece := file.read(HASH_PIECE_BYTES):
                digest.update(piece)
        return digest.hexdigest()

    def finish(self) -> None:
        """Put the complete file in place, in one step, on disk before it has its name."""
        with self.path.open("rb") as file:
            os.fsync(file.fileno())
        self.path.replace(self.target)
        self.discard()
