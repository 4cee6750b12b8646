"""The limits that only a parent can watch: wall time, resident memory of the whole family, size of the scratch folder."""

from __future__ import annotations

import os
import time
from pathlib import Path

from core.errors import LimitError
from sandbox.child import Child
from sandbox.child_main import file_too_large, out_of_memory
from sandbox.outcome import out_of_wall_time


def find_overrun(child: Child) -> LimitError | None:
    """The limit `child` has passed, if any; the caller kills it."""
    if time.monotonic() - child.started_at > child.limits.wall_s:
        return out_of_wall_time(child.limits)
    if child.memory_bytes() > child.limits.memory_bytes:
        return out_of_memory(child.limits)
    if folder_bytes(child.scratch) > child.limits.file_bytes:
        return file_too_large(child.limits)
    return None


def folder_bytes(folder: Path) -> int:
    """Disk space taken by everything below `folder`; files that vanish meanwhile count nothing."""
    total = 0
    for here, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.lstat(os.path.join(here, name)).st_blocks * 512
            except FileNotFoundError:
                continue
    return total
