"""A disk that runs full takes no new work, so that what was accepted can be finished and stored."""

from __future__ import annotations

import shutil
from pathlib import Path

from core.errors import LimitError


class DiskFloor:
    """Of the disk `folder` is on. `floor_bytes` 0: none."""

    def __init__(self, folder: Path, floor_bytes: int) -> None:
        self._folder = folder
        self.floor_bytes = floor_bytes

    def free_bytes(self) -> int:
        """Now."""
        return shutil.disk_usage(self._folder).free

    def require(self) -> None:
        """Raises LimitError `storage.low`."""
        if self.floor_bytes and (free := self.free_bytes()) < self.floor_bytes:
            raise LimitError(
                "storage.low",
                f"{free} bytes are free on this server, {self.floor_bytes} are needed to take new work; "
                "remove meshes and finished jobs, or ask an operator",
                free_bytes=free,
                floor_bytes=self.floor_bytes,
            )
