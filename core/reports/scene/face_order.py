"""An order of faces in which neighbours follow each other, and the small numbers that then describe a mesh."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Ints = NDArray[np.int32]
NO_TWIN = -1


def neighbours_first(faces: Ints, vertex_count: int) -> tuple[Ints, Ints]:
    """(faces (F, 3), order (V',)): the same faces along strips, their corners renumbered as they first appear.

    order[new] is the old number of a vertex; vertices of no face are left out. Each face keeps its orientation. Any triangles.
    """
    strips = _along_strips(faces, _twins(faces, vertex_count))
    renumbered: tuple[Ints, Ints] = _renumbered(strips, vertex_count)
    return renumbered


@njit(cache=True, nogil=True)
def _twins(faces: Ints, vertex_count: int) -> NDArray[np.int64]:
    """For each half edge 3 f + k the one that runs the other way, (3 F,), or NO_TWIN; the first of several."""
    first = np.zeros(vertex_count + 1, np.int64)
    for corner in faces.ravel():
        first[corner + 1] += 1
    for v in range(vertex_count):
        first[v + 1] += first[v]
    free = first[:-1].copy()
    leaving = np.empty(3 * len(faces), np.int64)
    for half in range(3 * len(faces)):
        v = faces[half // 3, half % 3]
        leaving[free[v]] = half
        free[v] += 1
    twin = np.full(3 * len(faces), NO_TWIN, np.int64)
    for half in range(3 * len(faces)):
        start, end = faces[half // 3, half % 3], faces[half // 3, (half % 3 + 1) % 3]
        for place in range(first[end], first[end + 1]):
            other = leaving[place]
            if faces[other // 3, (other % 3 + 1) % 3] == start:
                twin[half] = other
                break
    return twin


@njit(cache=True, nogil=True)
def _along_strips(faces: Ints, twin: NDArray[np.int64]) -> Ints:
    """From face to face across edges, always on from the last one; every face begins with the edge it was entered by."""
    done = np.zeros(len(faces), np.bool_)
    ordered = np.empty_like(faces)
    open_edges = np.empty(3 * len(faces) + 3, np.int64)
    count = 0
    for seed in range(len(faces)):
        open_edges[0], waiting = 3 * seed, 1
        while waiting:
            waiting -= 1
            f, k = open_edges[waiting] // 3, open_edges[waiting] % 3
            if done[f]:
                continue
            done[f] = True
            for corner in range(3):
                ordered[count, corner] = faces[f, (k + corner) % 3]
            count += 1
            for step in (2, 1):
                across = twin[3 * f + (k + step) % 3]
                if across != NO_TWIN and not done[across // 3]:
                    open_edges[waiting] = across
                    waiting += 1
    return ordered


@njit(cache=True, nogil=True)
def _renumbered(faces: Ints, vertex_count: int) -> tuple[Ints, Ints]:
    number = np.full(vertex_count, -1, np.int32)
    order = np.empty(vertex_count, np.int32)
    renamed = np.empty_like(faces)
    used = 0
    for f in range(len(faces)):
        for k in range(3):
            v = faces[f, k]
            if number[v] < 0:
                number[v] = used
                order[used] = v
                used += 1
            renamed[f, k] = number[v]
    return renamed, order[:used]


@njit(cache=True, nogil=True)
def steps_back(faces: Ints) -> NDArray[np.uint32]:
    """For every corner (F, 3) how far it lies behind the next new vertex: 0 is that vertex itself."""
    steps = np.empty(faces.shape, np.uint32)
    following = 0
    for f in range(len(faces)):
        for k in range(3):
            steps[f, k] = following - faces[f, k]
            if faces[f, k] == following:
                following += 1
    return steps


@njit(cache=True, nogil=True)
def off_prediction(faces: Ints, grid: NDArray[np.int64]) -> NDArray[np.int64]:
    """What each vertex (V, 3) is away from the middle of the corners its first face had before it, or from its predecessor.

    faces: as `neighbours_first` numbers them. grid (V, 3): coordinates as whole numbers from 0 on."""
    off = np.empty_like(grid)
    following = 0
    for f in range(len(faces)):
        for k in range(3):
            v = faces[f, k]
            if v != following:
                continue
            following += 1
            for axis in range(3):
                total, known = 0, 0
                for corner in range(3):
                    if faces[f, corner] < v:
                        total += grid[faces[f, corner], axis]
                        known += 1
                if known:
                    off[v, axis] = grid[v, axis] - total // known
                else:
                    off[v, axis] = grid[v, axis] - (grid[v - 1, axis] if v else 0)
    return off
