"""Exact intersections of a few faces with the whole surface, without testing all of it."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree, faces_of_leaf, push_children
from core.mesh import Faces, Vertices

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]


def find_crossings_of(vertices: Vertices, faces: Faces, chosen: Ints) -> Ints:
    """Pairs of faces that intersect, one of them among `chosen` (K,); (N, 2) face numbers, sorted by rows."""
    if len(chosen) == 0:
        return np.empty((0, 2), dtype=np.int64)
    near = np.flatnonzero(find_near(vertices, faces, chosen))
    used, corners = np.unique(faces[near], return_inverse=True)
    pairs = near[find_intersecting_faces(vertices[used], corners.reshape(-1, 3).astype(np.int32))]
    asked = np.zeros(len(faces), dtype=np.bool_)
    asked[chosen] = True
    found: Ints = pairs[asked[pairs].any(axis=1)]
    return found


def find_near(
    vertices: Vertices, faces: Faces, chosen: Ints, margin_mm: float = 0.0, tree: FaceTree | None = None
) -> NDArray[np.bool_]:
    """Faces whose boxes meet that of one of the `chosen` (K,), widened by a margin; the chosen themselves too. (F,).

    tree: of the surface, if there is one already; it may be one that has moved by less than the margin since."""
    tree = FaceTree.of(vertices, faces) if tree is None else tree
    corners = vertices[faces[chosen]]
    asked = np.concatenate((corners.min(axis=1) - margin_mm, corners.max(axis=1) + margin_mm), axis=1)
    found = np.zeros(len(faces), dtype=np.bool_)
    _mark(tree.boxes, tree.corners, tree.leaves, np.ascontiguousarray(asked), found)
    near = np.zeros(len(faces), dtype=np.bool_)
    near[tree.face[found]] = True
    return near


@njit(cache=True, nogil=True)
def _mark(boxes: Floats, corners: Floats, leaves: int, asked: Floats, found: NDArray[np.bool_]) -> None:
    """Mark, in tree order, the faces whose boxes meet one of the boxes asked (K, 6)."""
    stack = np.empty(256, np.int64)
    count = len(corners)
    for row in range(len(asked)):
        stack[0], top = 0, 1
        while top > 0:
            top -= 1
            node = stack[top]
            apart = False
            for axis in range(3):
                if asked[row, axis] > boxes[node, axis + 3] or asked[row, axis + 3] < boxes[node, axis]:
                    apart = True
            if apart:
                continue
            if node < leaves - 1:
                top = push_children(stack, top, node)
                continue
            for face in range(*faces_of_leaf(node, leaves, count)):
                met = True
                for axis in range(3):
                    a, b, c = corners[face, 0, axis], corners[face, 1, axis], corners[face, 2, axis]
                    if asked[row, axis] > max(a, b, c) or asked[row, axis + 3] < min(a, b, c):
                        met = False
                if met:
                    found[face] = True
