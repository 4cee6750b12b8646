"""Length units an upload may be in. Inside, everything is in millimetres."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.mesh import LARGEST_COORDINATE_MM, Vertices

Unit: TypeAlias = Literal["m", "cm", "mm", "in"]
MM_PER_UNIT: dict[Unit, float] = {"m": 1000.0, "cm": 10.0, "mm": 1.0, "in": 25.4}


def require_unit(text: str) -> Unit:
    """The unit named by `text`; InputError `unit.unknown` for any other word."""
    for unit in MM_PER_UNIT:
        if text == unit:
            return unit
    raise InputError("unit.unknown", f"the unit {text[:20]!r} is not known; use one of {', '.join(MM_PER_UNIT)}")


def convert_to_mm(vertices: NDArray[np.generic], faces: NDArray[np.integer], unit: Unit) -> Vertices:
    """Coordinates (V, 3) of any real type in `unit` -> float64 mm. `faces` (F, 3) only serve to name the first bad one.

    Checked before multiplying, so that nothing overflows on the way. A float32 coordinate in mm, cm or m comes out exact.
    Raises: InputError `mesh.not_finite`, `mesh.coordinate_out_of_range`.
    """
    points = vertices.astype(np.float64)
    bad = ~np.isfinite(points).all(axis=1)
    if bad.any():
        vertex, face = _first_place(np.flatnonzero(bad), faces)
        raise InputError(
            "mesh.not_finite",
            f"{int(bad.sum())} of {len(points)} vertices are NaN or infinite, first vertex {vertex} in face {face} (from 0)",
            count=int(bad.sum()),
            first_vertex=vertex,
            first_face=face,
        )
    largest = float(np.abs(points).max(initial=0.0))
    limit = LARGEST_COORDINATE_MM / MM_PER_UNIT[unit]
    if largest > limit:
        vertex, face = _first_place(np.flatnonzero(np.abs(points).max(axis=1) > limit), faces)
        raise InputError(
            "mesh.coordinate_out_of_range",
            f"a coordinate of {largest:g} {unit} is beyond the limit of {limit:g} {unit}; "
            f"the first is in vertex {vertex}, face {face} (from 0)",
            largest=largest,
            limit=limit,
            first_vertex=vertex,
            first_face=face,
        )
    points *= MM_PER_UNIT[unit]
    return points


def _first_place(bad: NDArray[np.int64], faces: NDArray[np.integer]) -> tuple[int, int]:
    """The first of the bad vertices and the first face that has it (-1 if none has)."""
    vertex = int(bad[0])
    used_by = np.flatnonzero((faces == vertex).any(axis=1))
    return vertex, int(used_by[0]) if len(used_by) else -1
