"""Children of a worker's nurseries that have a job; one more always waits for the next, and one may compile kernels."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import psutil


def children_at_work(worker: psutil.Process) -> dict[str, psutil.Process]:
    """Name of the job's folder, `<job>.<attempt's token>` -> the process that works in it."""
    found = {}
    for nursery in worker.children():
        for child in nursery.children():
            with suppress(psutil.Error):  # it ends at this moment
                folder = Path(child.cwd())
                if folder.parent.name == "jobs":
                    found[folder.name] = child
    return found
