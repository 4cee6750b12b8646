"""Faces taken from a mesh by a wall, and the rims they leave."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Edges, edges
from core.geometry.components import find_split_vertices
from core.mesh import Faces

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]


def tidy(faces: Faces, taken: Flags) -> Flags:
    """Make the rim of the taken faces (F,) of a closed manifold mesh short and simple; returns the new (F,).

    Notches of a single face are filled, which asks for no new vertex; then teeth of a single face and fans that hang on
    by one vertex are dropped, so every rim vertex lies on exactly one rim, once.
    """
    neighbours = _neighbours(edges(faces))
    taken = taken.copy()
    while (notch := ~taken & (taken[neighbours].sum(axis=1) >= 2)).any():
        taken |= notch
    while True:
        loose = taken & (taken[neighbours].sum(axis=1) <= 1)
        if not loose.any():
            loose = _hanging(faces, taken)
        if not loose.any():
            return taken
        taken &= ~loose


def _neighbours(mesh_edges: Edges) -> Ints:
    """The face across each side of each face of a closed manifold mesh, (F, 3)."""
    _edge, face, side = mesh_edges.two_faces()
    across = np.empty(mesh_edges.of_face.shape, dtype=np.int64)
    across[face[:, 0], side[:, 0]] = face[:, 1]
    across[face[:, 1], side[:, 1]] = face[:, 0]
    return across


def _hanging(faces: Faces, taken: Flags) -> Flags:
    """Taken faces at vertices where the taken faces form more than one fan."""
    chosen = faces[taken]
    split = find_split_vertices(chosen, edges(chosen)) if len(chosen) else np.empty(0, dtype=np.int64)
    at_split: Flags = taken & np.isin(faces, split).any(axis=1)
    return at_split


def find_rims(faces: Faces) -> list[Ints]:
    """Closed lines of vertices around faces (F, 3), each in the direction of its faces' sides.

    Needs one fan of faces at every vertex, see `tidy`. Begins with the lowest vertex; ordered by it.
    """
    found = edges(faces)
    row, side = np.nonzero(found.face_count[found.of_face] == 1)
    tails, heads = faces[row, side], faces[row, (side + 1) % 3]
    following = dict(zip(tails.tolist(), heads.tolist(), strict=True))
    rims = []
    while following:
        start = min(following)
        rim = [start]
        vertex = following.pop(start)
        while vertex != start:
            rim.append(vertex)
            vertex = following.pop(vertex)
        rims.append(np.array(rim, dtype=np.int64))
    return rims
