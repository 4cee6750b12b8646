"""What a report says about tissues that were separated."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.components import label_connected
from core.schema.counted import counted
from core.schema.separate import SeparateInputs
from core.separation.separate import Separated, Separation
from core.validation.measure import significant
from core.validation.places import point_of

Ints = NDArray[np.int64]

MAX_LISTED = 1000  # places of one tissue in a report, the farthest moved first; `count` says how many there are


def describe(separation: Separation, inputs: SeparateInputs) -> tuple[dict[str, Any], ...]:
    """Plain JSON facts: a table of all tissues, then for each that moved where and how far."""
    rows = [_row(name, tissue, inputs) for name, tissue in separation.tissues.items()]
    moved = [row for row in rows if row["moved_vertices"]]
    overview = {
        "mesh": "",
        "kind": "separation",
        "message": f"{len(moved)} of {len(rows)} tissues were moved to keep {inputs.min_gap_mm:g} mm between every two",
        "tissues": rows,
    }
    return (overview, *(_places(name, tissue) for name, tissue in separation.tissues.items() if (tissue.shift_mm > 0.0).any()))


def _row(name: str, tissue: Separated, inputs: SeparateInputs) -> dict[str, Any]:
    shifts = tissue.shift_mm[tissue.shift_mm > 0.0]
    return {
        "tissue": name,
        "may_move": "no" if name in inputs.fixed else "yes",
        "priority": inputs.priority.get(name, 0),
        "vertices": len(tissue.shift_mm),
        "faces_added": tissue.faces_added,
        "moved_vertices": len(shifts),
        "mean_shift_mm": significant(float(shifts.mean())) if len(shifts) else 0.0,
        "largest_shift_mm": significant(float(shifts.max(initial=0.0))),
    }


def _places(name: str, tissue: Separated) -> dict[str, Any]:
    """One place for each patch of moved vertices that hang together: where it moved farthest."""
    farthest = _farthest_of_patches(tissue)
    shifts = tissue.shift_mm[farthest]
    moved = tissue.shift_mm > 0.0
    return {
        "mesh": name,
        "kind": "gap_opened",
        "message": f"{int(moved.sum())} of {len(moved)} vertices moved at {counted(len(farthest), 'place')}, by "
        f"{tissue.shift_mm[moved].mean():.3g} mm on average and {shifts[0]:.3g} mm at most",
        "count": len(farthest),
        "max_distance_mm": significant(float(shifts[0])),
        "places": [
            {"point_mm": point_of(tissue.mesh.vertices[vertex]), "distance_mm": significant(float(shift))}
            for vertex, shift in zip(farthest[:MAX_LISTED], shifts, strict=False)
        ],
    }


def _farthest_of_patches(tissue: Separated) -> Ints:
    """Of every patch the vertex that moved farthest, (K,), the farthest of all first."""
    moved = np.flatnonzero(tissue.shift_mm > 0.0)
    ends = edges(tissue.mesh.faces).ends
    within = ends[(tissue.shift_mm[ends] > 0.0).all(axis=1)]
    number = np.full(len(tissue.shift_mm), -1, dtype=np.int64)
    number[moved] = np.arange(len(moved))
    _count, label = label_connected(len(moved), number[within[:, 0]], number[within[:, 1]])
    farthest_first = moved[np.argsort(-tissue.shift_mm[moved], kind="stable")]
    first = np.unique(label[number[farthest_first]], return_index=True)[1]
    result: Ints = farthest_first[np.sort(first)]
    return result
