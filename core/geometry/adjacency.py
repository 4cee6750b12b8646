"""Who touches whom: edges, faces at edges, faces and neighbours around vertices. All vectorised, all CSR."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.mesh import Faces

Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Edges:
    """The undirected edges of a mesh.

    ends: (E, 2) vertex numbers, lower first, sorted by rows. face_count: (E,) faces at each edge.
    of_face: (F, 3) edge numbers; side i runs from corner i to corner i+1. forward: (F, 3) True where the face runs
    along its side from the lower to the higher vertex number.
    A side between equal corners (a degenerate face) is an edge like any other, with equal ends.
    """

    ends: Ints
    face_count: Ints
    of_face: Ints
    forward: NDArray[np.bool_]

    def two_faces(self) -> tuple[Ints, Ints, Ints]:
        """Edges with exactly two faces: (edge (N,), face (N, 2), side (N, 2)); the lower face number comes first."""
        sides = np.argsort(self.of_face.ravel(), kind="stable")
        starts = np.cumsum(self.face_count) - self.face_count
        edge = np.flatnonzero(self.face_count == 2)
        halves = np.column_stack((sides[starts[edge]], sides[starts[edge] + 1]))
        return edge, halves // 3, halves % 3


def edges(faces: Faces) -> Edges:
    """Number the edges of faces (F, 3); O(F log F)."""
    tails = faces.astype(np.int64)
    heads = np.roll(tails, -1, axis=1)
    stride = int(tails.max(initial=0)) + 1
    keys = (np.minimum(tails, heads) * stride + np.maximum(tails, heads)).ravel()
    unique, of_side, count = np.unique(keys, return_inverse=True, return_counts=True)
    ends = np.column_stack((unique // stride, unique % stride))
    return Edges(ends, count.astype(np.int64), of_side.reshape(-1, 3).astype(np.int64), tails < heads)


@dataclass(frozen=True, eq=False, slots=True)
class Rows:
    """Lists of numbers, one per vertex, in CSR form: the list of v is `values[start[v]:start[v + 1]]`, ascending."""

    start: Ints
    values: NDArray[np.int32]

    def __getitem__(self, row: int) -> NDArray[np.int32]:
        """The list of one vertex."""
        return self.values[self.start[row] : self.start[row + 1]]


def _rows(keys: Ints, values: Ints, count: int) -> Rows:
    order = np.lexsort((values, keys))
    start = np.zeros(count + 1, dtype=np.int64)
    np.cumsum(np.bincount(keys, minlength=count), out=start[1:])
    return Rows(start, values[order].astype(np.int32))


def vertex_faces(faces: Faces, vertex_count: int) -> Rows:
    """Faces around each vertex; a face that repeats a corner is listed at it twice."""
    corners = faces.ravel().astype(np.int64)
    order = np.argsort(corners, kind="stable")
    start = np.zeros(vertex_count + 1, dtype=np.int64)
    np.cumsum(np.bincount(corners, minlength=vertex_count), out=start[1:])
    return Rows(start, (order // 3).astype(np.int32))


def vertex_neighbours(ends: Ints, vertex_count: int) -> Rows:
    """One-rings: vertices joined to each vertex by an edge; ends: (E, 2) of `edges(faces).ends`."""
    proper = ends[ends[:, 0] != ends[:, 1]]
    return _rows(proper.ravel(), proper[:, ::-1].ravel(), vertex_count)
