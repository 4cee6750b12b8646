"""Displacements that fade around where they are needed, so that a deep move bends the surface and tears no step into it."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.adjacency import Rows
from core.mesh import Vertices

Floats = NDArray[np.float64]

SLOPE = 0.35  # of the displacement along the surface: below it, neighbours stay where they are
MOST_SWEEPS = 200


def spread(vertices: Vertices, neighbours: Rows, displacement: Floats, slope: float = SLOPE) -> Floats:
    """Displacements (V, 3) mm enlarged so that none is longer than a neighbour's by more than `slope` times the edge between.

    vertices: (V, 3) mm before any displacement. Only short displacements grow; moves of a tenth of a millimetre on edges of
    millimetres drag nobody along.
    """
    result = displacement.copy()
    _sweep(vertices, neighbours.start, neighbours.values, slope, result)
    return result


def least_lengths(vertices: Vertices, neighbours: Rows, lengths: Floats, slope: float = SLOPE) -> Floats:
    """How long the displacement of each vertex must be, (V,) mm, given those of its neighbours (V,) mm; 0 or more."""
    owner = np.repeat(np.arange(len(vertices)), np.diff(neighbours.start))
    edge = np.linalg.norm(vertices[owner] - vertices[neighbours.values], axis=1)
    least: Floats = np.zeros(len(vertices))
    alone = np.diff(neighbours.start) == 0
    least[~alone] = np.maximum.reduceat(lengths[neighbours.values] - slope * edge, neighbours.start[:-1][~alone])
    return np.maximum(least, 0.0)


@njit(cache=True, nogil=True)
def _sweep(
    vertices: Vertices, start: NDArray[np.int64], neighbours: NDArray[np.int32], slope: float, displacement: Floats
) -> None:
    """In place, forwards and backwards in turn until nothing grows."""
    count = len(vertices)
    for sweep in range(MOST_SWEEPS):
        grown = False
        for step in range(count):
            vertex = step if sweep % 2 == 0 else count - 1 - step
            own = 0.0
            for axis in range(3):
                own += displacement[vertex, axis] ** 2
            own = math.sqrt(own)
            if own == 0.0:
                continue
            for entry in range(start[vertex], start[vertex + 1]):
                other = neighbours[entry]
                theirs, edge = 0.0, 0.0
                for axis in range(3):
                    theirs += displacement[other, axis] ** 2
                    edge += (vertices[vertex, axis] - vertices[other, axis]) ** 2
                least = own - slope * math.sqrt(edge)
                missing = least - math.sqrt(theirs)
                if missing > 1e-6 * own:
                    for axis in range(3):
                        displacement[other, axis] += missing * displacement[vertex, axis] / own
                    grown = True
        if not grown:
            return
