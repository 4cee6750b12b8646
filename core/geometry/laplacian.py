"""Means over neighbours and the simultaneous steps made of them: what smoothing and the removal of noise share."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.adjacency import Rows
from core.mesh import Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def neighbour_means(field: Floats, neighbours: Rows, chosen: Ints) -> Floats:
    """Mean over the neighbours of each chosen vertex, (K, 3); thesis Eq. (3.1) if the field is the vertices.

    field: (V, 3), one row per vertex. neighbours: one-rings. chosen: (K,) vertex numbers; one without neighbours keeps its row.
    """
    means = np.empty((len(chosen), 3))
    _mean(field, neighbours.start, neighbours.values, chosen, means)
    return means


def laplacian_step(vertices: Vertices, neighbours: Rows, chosen: Ints, share: float) -> Vertices:
    """All chosen vertices (K,) go this share of the way to the mean of their neighbours at once; (V, 3) mm.

    A negative share leads away from it.
    """
    moved = vertices.copy()
    moved[chosen] += share * (neighbour_means(vertices, neighbours, chosen) - vertices[chosen])
    return moved


def taubin_step(vertices: Vertices, neighbours: Rows, chosen: Ints, inwards: float, outwards: float) -> Vertices:
    """A step in, then a larger step out: takes out noise and leaves the large shape; (V, 3) mm.

    inwards: λ > 0, outwards: μ < -λ; waves with an eigenvalue of the ring's Laplacian below 1/λ + 1/μ are not damped.
    Source: Taubin 1995, doi:10.1145/218380.218473.
    """
    return laplacian_step(laplacian_step(vertices, neighbours, chosen, inwards), neighbours, chosen, outwards)


@njit(cache=True, nogil=True)
def _mean(field: Floats, start: Ints, ring: NDArray[np.int32], chosen: Ints, means: Floats) -> None:
    """means (K, 3) is filled."""
    for i in range(len(chosen)):
        vertex = chosen[i]
        count = start[vertex + 1] - start[vertex]
        if count == 0:
            means[i, 0], means[i, 1], means[i, 2] = field[vertex, 0], field[vertex, 1], field[vertex, 2]
            continue
        x, y, z = 0.0, 0.0, 0.0
        for k in range(start[vertex], start[vertex + 1]):
            x, y, z = x + field[ring[k], 0], y + field[ring[k], 1], z + field[ring[k], 2]
        means[i, 0], means[i, 1], means[i, 2] = x / count, y / count, z / count
