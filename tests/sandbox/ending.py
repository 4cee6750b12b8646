"""Waiting for the end of processes that are not our children."""

from __future__ import annotations

import os
import select
import time
from collections.abc import Iterable
from pathlib import Path


def wait_for_end(pids: Iterable[int], timeout_s: float = 10.0) -> list[int]:
    """The pids that still run after `timeout_s`; a zombie has ended."""
    deadline = time.monotonic() + timeout_s
    alive = []
    for pid in pids:
        try:
            descriptor = os.pidfd_open(pid)
        except ProcessLookupError:
            continue
        with os.fdopen(descriptor, "rb") as ending:
            if not select.select([ending], [], [], max(0.0, deadline - time.monotonic()))[0] and Path(f"/proc/{pid}").exists():
                alive.append(pid)
    return alive
