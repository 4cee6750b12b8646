"""Which vertices and faces of a closed manifold touch, in lists made for kernels."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.adjacency import Rows
from core.mesh import Faces

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Connectivity:
    """Which vertices and faces of a closed oriented manifold touch.

    faces: (F, 3). faces_around, neighbours: one list per vertex, equally long: the i-th neighbour follows the vertex in its
    i-th face.
    """

    faces: Faces
    vertex_count: int
    faces_around: Rows
    neighbours: Rows

    @classmethod
    def of(cls, faces: Faces, vertex_count: int) -> Connectivity:
        """O(F)."""
        start = np.zeros(vertex_count + 1, dtype=np.int64)
        np.cumsum(np.bincount(faces.ravel(), minlength=vertex_count), out=start[1:])
        around, neighbours = np.empty(3 * len(faces), np.int32), np.empty(3 * len(faces), np.int32)
        _list(faces, start[:-1].copy(), around, neighbours)
        return cls(faces, vertex_count, Rows(start, around), Rows(start, neighbours))

    def faces_of(self, vertices: Flags) -> Ints:
        """Numbers of the faces with a corner among the vertices (V,)."""
        found = np.zeros(len(self.faces), dtype=np.bool_)
        _mark_around(self.faces_around.start, self.faces_around.values, np.flatnonzero(vertices), found)
        return np.flatnonzero(found)

    def corners_of(self, faces: Ints) -> Flags:
        """The vertices of some faces, as flags (V,)."""
        flags = np.zeros(self.vertex_count, dtype=np.bool_)
        flags[self.faces[faces].ravel()] = True
        return flags

    def grown(self, vertices: Flags) -> Flags:
        """The vertices and their neighbours."""
        grown = vertices.copy()
        _mark_around(self.neighbours.start, self.neighbours.values, np.flatnonzero(vertices), grown)
        return grown


@njit(cache=True, nogil=True)
def _list(faces: Faces, free: Ints, around: NDArray[np.int32], neighbours: NDArray[np.int32]) -> None:
    """Fill the lists; free (V,): where the next entry of each vertex goes, used up."""
    for face in range(len(faces)):
        for corner in range(3):
            vertex = faces[face, corner]
            around[free[vertex]] = face
            neighbours[free[vertex]] = faces[face, (corner + 1) % 3]
            free[vertex] += 1


@njit(cache=True, nogil=True)
def _mark_around(start: Ints, values: NDArray[np.int32], vertices: Ints, found: Flags) -> None:
    """Mark everything in the lists of some vertices."""
    for vertex in vertices:
        for i in range(start[vertex], start[vertex + 1]):
            found[values[i]] = True
