"""Which columns of a table are places and which the field."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.field_source import FieldTable

Floats = NDArray[np.float64]
PLACES = ("x", "y", "z")
VECTOR = ("ex", "ey", "ez")
MAGNITUDE = "mage"
SPELLED = {"ex": "Ex", "ey": "Ey", "ez": "Ez", MAGNITUDE: "magE"}
ALSO_MAGNITUDE = frozenset({"mage", "magne", "norme", "emag", "e", "|e|", "abse"})


@dataclass(frozen=True, eq=False, slots=True)
class FieldPoints:
    """Places (N, 3) mm and values (N, 3) or, of magnitudes alone, (N, 1); all finite, no two at one place.

    rows: of the file. left_out: rows that were not finite. merged: rows at places of others, whose mean was taken.
    """

    points: Floats
    values: Floats
    rows: int
    left_out: int
    merged: int


def points_of(table: FieldTable, columns: Sequence[str] | None, not_finite: Literal["refuse", "leave_out"]) -> FieldPoints:
    """The columns called x, y, z and Ex, Ey, Ez (or magE), in any order and case.

    columns: their names from left to right, as the caller says; None: as the file's header says. Others are ignored.
    Raises: InputError `fields.columns_missing`, `fields.columns_differ`, `fields.not_finite`.
    """
    if columns is not None and len(columns) > len(table.names):
        raise InputError(
            "fields.columns_differ",
            f"{len(columns)} columns were named, the file has {len(table.names)}",
            named=len(columns),
            columns=len(table.names),
        )
    named = _known(table.names if columns is None else columns)
    parts = [name for name in VECTOR if name in named]
    field = VECTOR if len(parts) == len(VECTOR) or (parts and MAGNITUDE not in named) else (MAGNITUDE,)
    missing = [name for name in (*PLACES, *field) if name not in named]
    if missing:
        raise _missing(table, columns, missing)
    chosen = np.column_stack([table.columns[named[name]] for name in (*PLACES, *field)])
    finite = np.isfinite(chosen).all(axis=1)
    bad = int((~finite).sum())
    if bad and (not_finite == "refuse" or bad == len(chosen)):
        first = int(np.flatnonzero(~finite)[0]) + 1
        raise InputError(
            "fields.not_finite",
            f"{bad} of {len(chosen)} rows have NaN or infinite numbers, the first is row {first}; "
            'send `"not_finite": "leave_out"` if they stand for places without a field',
            count=bad,
            first_row=first,
        )
    kept = chosen[finite]
    points, values = _merged(kept[:, :3] * table.mm_per_unit, kept[:, 3:])
    return FieldPoints(points, values, len(chosen), bad, len(kept) - len(points))


def _known(names: Sequence[str]) -> dict[str, int]:
    """Name without unit, in lower case -> number of its column; of columns alike the first."""
    known: dict[str, int] = {}
    for number, name in enumerate(names):
        plain = re.sub(r"[\[(].*", "", name).strip().lower().replace("_", "").replace("-", "")
        known.setdefault(MAGNITUDE if plain in ALSO_MAGNITUDE else plain, number)
    return known


def _missing(table: FieldTable, columns: Sequence[str] | None, missing: list[str]) -> InputError:
    if columns is not None:
        told = f"the columns named are {', '.join(columns)[:200]}"
    elif any(table.names):
        told = f"the file's header names {', '.join(name or '(none)' for name in table.names)[:200]}"
    else:
        told = f"the file has no header for its {len(table.names)} columns"
    called = ", ".join(SPELLED.get(name, name) for name in missing)
    return InputError(
        "fields.columns_missing",
        f"no column is called {called}: {told}; name all columns from left to right, as x y z Ex Ey Ez, or magE",
        columns=len(table.names),
    )


def _merged(points: Floats, values: Floats) -> tuple[Floats, Floats]:
    """One row for each place, with the mean of its values: exports by element repeat the nodes that elements share."""
    order = np.lexsort(points.T[::-1])
    ordered = points[order]
    first = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(axis=1)])
    if first.all():
        return points, values
    place = np.cumsum(first) - 1
    counts = np.bincount(place)
    means = np.column_stack([np.bincount(place, column[order]) / counts for column in values.T])
    return ordered[first], means
