"""A log of bounded size: the current file and one older one."""

from __future__ import annotations

from pathlib import Path

LIMIT_BYTES = 5_000_000
TAIL_BYTES = 8_000


class LogFile:
    """Appends to `path`; when that is full it becomes `path` + `.1`, so at most 2 × limit bytes lie on disk."""

    def __init__(self, path: Path, limit_bytes: int = LIMIT_BYTES) -> None:
        """The folder must exist. A file from an earlier run is continued."""
        self.path = path
        self._limit_bytes = limit_bytes
        self._open()

    def _open(self) -> None:
        self._file = self.path.open("ab", buffering=0)
        self._size = self._file.tell()

    def write(self, chunk: bytes) -> None:
        """Append; a chunk may pass the limit by its own length."""
        if self._size and self._size + len(chunk) > self._limit_bytes:
            self._file.close()
            self.path.replace(self.older)
            self._open()
        self._file.write(chunk)
        self._size += len(chunk)

    @property
    def older(self) -> Path:
        """Where the lines before those in `path` are."""
        return self.path.with_name(self.path.name + ".1")

    def tail(self, lines: int = 20) -> str:
        """The last lines, for an error message."""
        with self.path.open("rb") as file:
            file.seek(max(0, file.seek(0, 2) - TAIL_BYTES))
            return "\n".join(file.read().decode(errors="replace").splitlines()[-lines:])

    def close(self) -> None:
        """Nothing is buffered, so this loses nothing."""
        self._file.close()
