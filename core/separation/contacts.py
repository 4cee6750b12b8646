"""Faces of two surfaces that come closer than a limit, with the closest place of each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.face_tree import FaceTree, faces_of_leaf, push_children
from core.geometry.triangle_distance import nearer

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

COINCIDENT_MM = 1e-4  # nearer than this, nobody can tell on which side a face lies


@dataclass(frozen=True, eq=False, slots=True)
class Contacts:
    """One surface against another: faces (K,) that come too close, ascending, how close (K,) mm and where (K, 3) mm.

    0 mm if the face crosses the other surface. The place lies halfway to the other surface.
    """

    faces: Ints
    distance_mm: Floats
    points: Floats


def find_contacts(a: FaceTree, b: FaceTree, limit_mm: float) -> tuple[Contacts, Contacts]:
    """Contacts of a with b and of b with a; O(n log n) in the faces, plus the pairs that are closer than the limit."""
    squared_a, squared_b = np.full(len(a.face), limit_mm**2), np.full(len(b.face), limit_mm**2)
    points_a, points_b = np.empty((len(a.face), 3)), np.empty((len(b.face), 3))
    _measure(a.corners, b.boxes, b.corners, b.leaves, limit_mm, squared_a, points_a, squared_b, points_b)
    return _contacts(a, squared_a, points_a, limit_mm), _contacts(b, squared_b, points_b, limit_mm)


def _contacts(tree: FaceTree, squared: Floats, points: Floats, limit_mm: float) -> Contacts:
    found = np.flatnonzero(squared < limit_mm**2)
    found = found[np.argsort(tree.face[found], kind="stable")]
    return Contacts(tree.face[found], np.sqrt(squared[found]), points[found])


@njit(cache=True, nogil=True)
def _measure(
    corners: Floats,
    boxes: Floats,
    others: Floats,
    leaves: int,
    limit: float,
    squared: Floats,
    points: Floats,
    squared_other: Floats,
    points_other: Floats,
) -> None:
    """Lower the squared distances of faces in tree order, (F,) and (G,), to that of their closest partner; fill its place."""
    stack, heights, point = np.empty(256, np.int64), np.empty((2, 3)), np.empty(3)
    low, high = np.empty(3), np.empty(3)
    count = len(others)
    for face in range(len(corners)):
        for axis in range(3):
            p, q, r = corners[face, 0, axis], corners[face, 1, axis], corners[face, 2, axis]
            low[axis], high[axis] = min(p, q, r) - limit, max(p, q, r) + limit
        stack[0], top = 0, 1
        while top > 0:
            top -= 1
            node = stack[top]
            if low[0] > boxes[node, 3] or low[1] > boxes[node, 4] or low[2] > boxes[node, 5]:
                continue
            if high[0] < boxes[node, 0] or high[1] < boxes[node, 1] or high[2] < boxes[node, 2]:
                continue
            if node < leaves - 1:
                top = push_children(stack, top, node)
                continue
            for other in range(*faces_of_leaf(node, leaves, count)):
                most = max(squared[face], squared_other[other])
                if most == 0.0:
                    continue
                found = nearer(corners, face, others, other, most, heights, point)
                if found < squared[face]:
                    squared[face] = found
                    points[face, 0], points[face, 1], points[face, 2] = point[0], point[1], point[2]
                if found < squared_other[other]:
                    squared_other[other] = found
                    points_other[other, 0], points_other[other, 1], points_other[other, 2] = point[0], point[1], point[2]
