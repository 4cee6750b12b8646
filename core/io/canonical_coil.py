"""The internal form of a coil on disk: what the store keeps and jobs load. Equal coils give equal bytes."""

from __future__ import annotations

from pathlib import Path

from core.coil import Coil
from core.errors import InputError
from core.io.array_file import corrupt, read_arrays, write_arrays

MAGIC = b"INTCOIL1"
ARRAYS = ("positions", "moments", "wire", "wire_along")


def save_coil(coil: Coil, path: Path) -> None:
    """Write the coil."""
    write_arrays(path, MAGIC, {name: getattr(coil, name) for name in ARRAYS})


def load_coil(path: Path) -> Coil:
    """Read it back. Raises: InternalError `canonical.corrupt`."""
    tables = read_arrays(path, MAGIC)
    try:
        return Coil.of(*(tables[name] for name in ARRAYS))
    except (ValueError, TypeError, KeyError, InputError) as error:
        raise corrupt(f"it does not describe a coil: {error}") from error
