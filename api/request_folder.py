"""A folder per request for what must not stay in memory, gone when the request is."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from uuid import uuid4

LEFT_BEHIND_S = 900.0  # a request that wrote nothing for that long has no server any more


@contextmanager
def request_folder(incoming: Path) -> Iterator[Path]:
    """An empty folder below `incoming`, removed with everything in it, whatever happens."""
    folder = incoming / uuid4().hex
    folder.mkdir(parents=True, mode=0o700)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def sweep_incoming(incoming: Path, older_than_s: float) -> int:
    """Remove what a killed server left: folders nothing was written to for that long. Returns how many."""
    incoming.mkdir(parents=True, exist_ok=True, mode=0o700)
    found = find_left_behind(incoming, older_than_s)
    for folder in found:
        shutil.rmtree(folder, ignore_errors=True)
    return len(found)


def find_left_behind(incoming: Path, older_than_s: float) -> list[Path]:
    """Folders of requests nothing was written to for that long."""
    before = time.time() - older_than_s
    return [folder for folder in incoming.iterdir() if _last_write(folder) < before] if incoming.is_dir() else []


def _last_write(folder: Path) -> float:
    """When anything in it was last written to; now, if it vanishes under our eyes: its owner is at work."""
    try:
        return max(path.stat().st_mtime for path in (folder, *folder.rglob("*")))
    except FileNotFoundError:
        return time.time()
