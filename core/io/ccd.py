"""Coils as magnetic dipoles in text, .ccd: metres and A·m². Written here; SimNIBS reads and writes the format."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from core.coil import Coil
from core.errors import InputError
from core.io.text_table import read_table
from core.schema.finding import Finding, Severity

EXTENSION = ".ccd"
MM_PER_M = 1000.0
HEAD_LINES = 50
COLUMNS = 6


def read_ccd(path: Path) -> tuple[Coil, tuple[Finding, ...]]:
    """Comments, the number of dipoles, comments, and a row x y z mx my mz for each.

    Raises: InputError `coil.count_mismatch`, `coil.columns`, and those of `Coil.of` and `read_table`; LimitError as that.
    """
    announced, skip = _find_count(path)
    rows = read_table(path, skip=skip).columns.T
    if rows.shape[1] != COLUMNS:
        raise InputError(
            "coil.columns",
            f"the dipoles have {rows.shape[1]} columns; x y z in m and mx my mz in A·m² are wanted",
            columns=rows.shape[1],
        )
    coil = Coil.of(rows[:, :3] * MM_PER_M, rows[:, 3:])
    if announced is None:
        message = f"the file does not say how many dipoles it has; {len(rows)} were read"
        return coil, (Finding(code="coil.count_missing", severity=Severity.INFO, message=message, count=1),)
    if announced != len(rows):
        raise InputError(
            "coil.count_mismatch",
            f"the file announces {announced} dipoles and has {len(rows)}",
            announced=announced,
            found=len(rows),
        )
    return coil, ()


def _find_count(path: Path) -> tuple[int | None, int]:
    """The lone whole number before the dipoles, if there is one, and the lines up to it."""
    with path.open(encoding="latin-1") as file:
        for number, line in enumerate(islice(file, HEAD_LINES)):
            words = line[:200].split()
            if not words or words[0].startswith("#") or "=" in line:
                continue
            if len(words) == 1 and words[0].isascii() and words[0].isdigit():
                return int(words[0]), number + 1
            return None, number
    return None, 0
