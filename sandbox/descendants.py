"""Who belongs to a process, straight from /proc: a few file reads per process instead of a scan of the whole machine."""

from __future__ import annotations

import os
from pathlib import Path

_PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


def children_of(pid: int) -> list[int]:
    """Direct children over all threads of `pid`; empty when it is gone (or the kernel lacks CONFIG_PROC_CHILDREN)."""
    found: list[int] = []
    try:
        for task in Path(f"/proc/{pid}/task").iterdir():
            found += map(int, (task / "children").read_text().split())
    except (FileNotFoundError, ProcessLookupError):  # it ended while we looked
        return found
    return found


def with_descendants(pid: int) -> list[int]:
    """`pid` and everything it started, directly or not, that has not been handed to another parent."""
    family = [pid]
    for member in family:  # grows while we walk it
        family += children_of(member)
    return family


def resident_bytes(pid: int) -> int:
    """Memory of one process now, pages shared with its parent included; 0 when it is gone."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * _PAGE_BYTES
    except (FileNotFoundError, ProcessLookupError):
        return 0
