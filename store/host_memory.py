"""How much memory jobs may take on this host: what the machine has, or the control group we are in, less a share for others."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

SHARE_OF_JOBS = 0.8  # the rest is for the worker itself, the nursery's libraries and the system
UNLIMITED = 1 << 60  # control groups of version 1 without a limit say a number near 2**63


def budget_bytes(root: Path = Path("/")) -> int:
    """What the jobs of this host may need together."""
    return int(SHARE_OF_JOBS * min([physical_bytes(), *_limits(root)]))


def physical_bytes() -> int:
    """Memory of the machine."""
    return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")


def _limits(root: Path) -> Iterator[int]:
    """The limits of our control group and of those around it; in a container its own group is the root of what it sees."""
    try:
        lines = (root / "proc/self/cgroup").read_text().splitlines()
    except OSError:
        return
    for line in lines:
        _, controllers, group = line.split(":", 2)
        if controllers == "":
            base, name = root / "sys/fs/cgroup", "memory.max"
        elif "memory" in controllers.split(","):
            base, name = root / "sys/fs/cgroup/memory", "memory.limit_in_bytes"
        else:
            continue
        here = Path(group.lstrip("/"))
        for folder in (here, *here.parents):
            try:
                told = (base / folder / name).read_text().strip()
            except OSError:
                continue
            if told.isdecimal() and 0 < int(told) < UNLIMITED:
                yield int(told)
