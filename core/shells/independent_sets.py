"""Vertices in sets of which no two are neighbours: what can be tried one by one, all of a set at once."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.connectivity import Connectivity

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

MOST_SETS = 16


def independent_sets(net: Connectivity, chosen: Flags) -> list[Ints]:
    """Split the chosen vertices (V,) greedily, in the order of their numbers.

    A vertex whose neighbours are in all of `MOST_SETS` is left out.
    """
    colour = np.full(net.vertex_count, -1, dtype=np.int64)
    vertices = np.flatnonzero(chosen)
    _colour(net.neighbours.start, net.neighbours.values, vertices, colour)
    return [vertices[colour[vertices] == number] for number in range(int(colour.max(initial=-1)) + 1)]


@njit(cache=True, nogil=True)
def _colour(start: Ints, neighbours: NDArray[np.int32], vertices: Ints, colour: Ints) -> None:
    """Smallest colour that no neighbour has; colour (V,) must hold -1."""
    for vertex in vertices:
        taken = 0
        for i in range(start[vertex], start[vertex + 1]):
            other = colour[neighbours[i]]
            if other >= 0:
                taken |= 1 << other
        for number in range(MOST_SETS):
            if not taken & (1 << number):
                colour[vertex] = number
                break
