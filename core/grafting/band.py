"""A band of triangles between two closed lines."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.mesh import Faces

Floats = NDArray[np.float64]

STARTS = 8  # partners of the first vertex that are tried; the best band nearly always starts at the nearest one


def triangulate_band(outer: Floats, inner: Floats) -> Faces:
    """Join two closed lines that run side by side the same way by the band with the least sum of squared cross edges.

    outer: (N, 3) mm. inner: (M, 3) mm. Returns (N + M, 3): numbers below N are outer's, inner's follow. Faces run along
    outer's edges backwards and along inner's forwards.
    Source: Fuchs, Kedem & Uselton 1977, doi:10.1145/359842.359846, a shortest path in a toroidal graph.
    """
    count, inner_count = len(outer), len(inner)
    squared = ((outer[:, None, :] - inner[None, :, :]) ** 2).sum(axis=2)
    best, path, first = np.inf, np.empty(0, dtype=np.bool_), 0
    for start in np.argsort(squared[0], kind="stable")[:STARTS]:
        turned = np.ascontiguousarray(np.roll(squared, -start, axis=1))
        total, steps = _cheapest_path(turned)
        if total < best:
            best, path, first = total, steps, int(start)
    faces = np.empty((count + inner_count, 3), dtype=np.int32)
    i = j = 0
    for number, along_outer in enumerate(path):
        here = count + (first + j) % inner_count
        if along_outer:
            faces[number] = (i + 1) % count, i % count, here
            i += 1
        else:
            faces[number] = here, count + (first + j + 1) % inner_count, i % count
            j += 1
    return faces


@njit(cache=True, nogil=True)
def _cheapest_path(squared: Floats) -> tuple[float, NDArray[np.bool_]]:
    """Path from cell (0, 0) around both lines to (N, M) with the least sum of squared (N, M): (sum, True per step down)."""
    rows, columns = squared.shape
    cost = np.empty((rows + 1, columns + 1))
    down = np.zeros((rows + 1, columns + 1), dtype=np.bool_)
    for i in range(rows + 1):
        for j in range(columns + 1):
            here = squared[i % rows, j % columns]
            if i == 0 and j == 0:
                cost[i, j] = here
            elif j == 0 or (i > 0 and cost[i - 1, j] <= cost[i, j - 1]):
                cost[i, j] = cost[i - 1, j] + here
                down[i, j] = True
            else:
                cost[i, j] = cost[i, j - 1] + here
    steps = np.empty(rows + columns, dtype=np.bool_)
    i, j = rows, columns
    while i > 0 or j > 0:
        steps[i + j - 1] = down[i, j]
        if down[i, j]:
            i -= 1
        else:
            j -= 1
    return float(cost[rows, columns]), steps
