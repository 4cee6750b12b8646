"""Which parts of one surface lie inside another, asked once for every part that the other does not cut."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.containment import is_inside
from core.geometry.face_tree import FaceTree
from core.mesh import Faces, Vertices

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]


def are_faces_inside(vertices: Vertices, faces: Faces, other: FaceTree, meeting: Ints) -> Flags:
    """True for each face (F,) whose middle lies inside the closed surface of the tree.

    meeting: (K,) faces that cross or touch the other surface; those that hang together without them lie on one side.
    """
    uncut, part_inside = _parts(vertices, faces, other, meeting)
    inside = np.zeros(len(faces), dtype=np.bool_)
    inside[uncut] = part_inside
    inside[meeting] = is_inside(other, vertices[faces[meeting]].mean(axis=1))
    return inside


def are_vertices_inside(vertices: Vertices, faces: Faces, other: FaceTree, meeting: Ints) -> Flags:
    """As `are_faces_inside`, for each vertex (V,)."""
    uncut, part_inside = _parts(vertices, faces, other, meeting)
    inside = np.zeros(len(vertices), dtype=np.bool_)
    inside[faces[uncut].ravel()] = np.repeat(part_inside, 3)
    alone = np.ones(len(vertices), dtype=np.bool_)
    alone[faces[uncut].ravel()] = False
    inside[alone] = is_inside(other, vertices[alone])
    return inside


def _parts(vertices: Vertices, faces: Faces, other: FaceTree, meeting: Ints) -> tuple[Ints, Flags]:
    """Faces that do not meet the other surface, and for each of them whether its part lies inside."""
    uncut = np.setdiff1d(np.arange(len(faces)), meeting)
    if len(uncut) == 0:
        return uncut, np.zeros(0, dtype=np.bool_)
    label = face_components(edges(faces[uncut]))[1]
    first = np.unique(label, return_index=True)[1]
    inside = is_inside(other, vertices[faces[uncut[first]]].mean(axis=1))
    result: Flags = inside[label]
    return uncut, result
