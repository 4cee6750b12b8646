"""Data files inside installed wheels, found without importing what they belong to."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, files
from pathlib import Path


def wheel_file(distribution: str, name: str) -> Path:
    """Where a file of a distribution lies on disk.

    Raises: LookupError if it is not installed (`make test`, `make demo` and `make bench` install all of them).
    """
    try:
        for file in files(distribution) or ():
            if str(file) == name:
                return Path(str(file.locate()))
    except PackageNotFoundError as missing:
        raise LookupError(f"the wheel '{distribution}' is not installed; `make .venv/.synced` does it") from missing
    raise LookupError(f"the wheel '{distribution}' holds no {name}")
