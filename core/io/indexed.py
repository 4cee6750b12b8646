"""From the two arrays of an indexed format (MAT, PLY, OBJ) to a piece: indices checked, vertices without faces left out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.io.reading import Piece, Reading
from core.io.welding import weld
from core.schema.finding import Finding, Severity

NO_ARRAYS: Mapping[str, NDArray[np.float64]] = {}


def assemble(
    vertices: NDArray[np.generic],
    faces: NDArray[np.int64],
    findings: tuple[Finding, ...],
    *,
    base: int,
    arrays: Mapping[str, NDArray[np.float64]] = NO_ARRAYS,
) -> Reading:
    """Vertices (V, 3) and 0-based faces (F, 3) -> one piece; `base` is the first index of the format, for messages.

    The file's connectivity is kept: vertices with equal coordinates stay apart and are told, vertices of no face go, and so
    do the numbers that `arrays` (V,) has for them.
    Raises: InputError `mesh.empty`, `mesh.index_out_of_range`.
    """
    if len(vertices) == 0 or len(faces) == 0:
        raise InputError("mesh.empty", f"the mesh has {len(vertices)} vertices and {len(faces)} faces")
    outside = ((faces < 0) | (faces >= len(vertices))).any(axis=1)
    if outside.any():
        low, high, first = int(faces.min()) + base, int(faces.max()) + base, int(np.flatnonzero(outside)[0])
        raise InputError(
            "mesh.index_out_of_range",
            f"{int(outside.sum())} of {len(faces)} faces have indices that no vertex has, the first is face {first} (from 0): "
            f"indices run from {low} to {high}, {len(vertices)} vertices allow {base} to {len(vertices) - 1 + base}",
            lowest=low,
            highest=high,
            vertices=len(vertices),
            first_face=first,
        )
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[faces] = True
    kept = vertices[used]
    number = np.cumsum(used) - 1
    told = (*findings, *_check_unused(used), *_check_coincident(kept))
    return Reading((Piece("", kept, number[faces], {name: values[used] for name, values in arrays.items()}),), told)


def _check_unused(used: NDArray[np.bool_]) -> list[Finding]:
    count = int(len(used) - used.sum())
    if not count:
        return []
    message = f"{count} of {len(used)} vertices belong to no face and were left out"
    return [Finding(code="mesh.unused_vertices", severity=Severity.INFO, message=message, count=count)]


def _check_coincident(vertices: NDArray[np.generic]) -> list[Finding]:
    welded, _ = weld(vertices)
    count = len(vertices) - len(welded)
    if not count:
        return []
    message = f"{count} of {len(vertices)} vertices repeat the coordinates of another; they were kept apart as in the file"
    return [Finding(code="mesh.coincident_vertices", severity=Severity.ERROR, message=message, count=count)]
