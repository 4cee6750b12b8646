"""Which tetrahedron holds a point, and how far each of its corners counts there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.chunks import in_chunks
from core.geometry.distance import STACK
from core.geometry.face_tree import FaceTree, faces_of_leaf, push_children

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
NOWHERE = -1
SLACK = 1e-9  # weights above -SLACK are inside: rounding leaves no cracks between neighbours


@dataclass(frozen=True, eq=False, slots=True)
class TetrahedronTree:
    """boxes: a tree over boxes around tetrahedra; corners: (K, 4, 3) mm of the tetrahedra, in the tree's order."""

    boxes: FaceTree
    corners: Floats

    @classmethod
    def of(cls, corners: Floats) -> TetrahedronTree:
        """Build over corners (K, 4, 3) mm, K >= 1."""
        low, high = corners.min(axis=1), corners.max(axis=1)
        boxes = FaceTree.of_corners(np.stack([low, high, 0.5 * (low + high)], axis=1))
        return cls(boxes, np.ascontiguousarray(corners[boxes.face]))

    def find(self, points: Floats) -> tuple[Ints, Floats]:
        """Number of the tetrahedron (N,) that holds each point (N, 3) mm, or NOWHERE, and weights (N, 4) of its corners.

        Where several do, at their common corners and sides, it is the one the point is deepest in."""
        asked = np.array(points, dtype=np.float64, order="C")
        found, weights = np.full(len(asked), NOWHERE, np.int64), np.zeros((len(asked), 4))
        tree = self.boxes

        def find(start: int, end: int) -> None:
            rows = slice(start, end)
            _find_containing(tree.boxes, tree.leaves, self.corners, asked[rows], found[rows], weights[rows])

        in_chunks(len(asked), find)
        inside = found != NOWHERE
        found[inside] = tree.face[found[inside]]
        return found, weights


@njit(cache=True, nogil=True)
def _find_containing(boxes: Floats, leaves: int, corners: Floats, points: Floats, found: Ints, weights: Floats) -> None:
    """Fill found (N,) in tree order and weights (N, 4)."""
    stack, trial = np.empty(STACK, np.int64), np.empty(4)
    count = len(corners)
    for i in range(len(points)):
        stack[0], top, deepest = 0, 1, -SLACK
        while top > 0:
            top -= 1
            node = stack[top]
            if not _in_box(boxes, node, points, i):
                continue
            if node < leaves - 1:
                top = push_children(stack, top, node)
                continue
            for candidate in range(*faces_of_leaf(node, leaves, count)):
                least = _weigh(corners, candidate, points, i, trial)
                if least > deepest:
                    deepest, found[i] = least, candidate
                    weights[i] = trial


@njit(cache=True, nogil=True)
def _in_box(boxes: Floats, node: int, points: Floats, i: int) -> bool:
    for axis in range(3):
        slack = SLACK * (boxes[node, axis + 3] - boxes[node, axis])
        if points[i, axis] < boxes[node, axis] - slack or points[i, axis] > boxes[node, axis + 3] + slack:
            return False
    return True


@njit(cache=True, nogil=True)
def _weigh(corners: Floats, t: int, points: Floats, i: int, weights: Floats) -> float:
    """Barycentric weights (4,) of a point in tetrahedron t; returns the least, -1 if the tetrahedron is flat."""
    ux, uy, uz = corners[t, 1, 0] - corners[t, 0, 0], corners[t, 1, 1] - corners[t, 0, 1], corners[t, 1, 2] - corners[t, 0, 2]
    vx, vy, vz = corners[t, 2, 0] - corners[t, 0, 0], corners[t, 2, 1] - corners[t, 0, 1], corners[t, 2, 2] - corners[t, 0, 2]
    wx, wy, wz = corners[t, 3, 0] - corners[t, 0, 0], corners[t, 3, 1] - corners[t, 0, 1], corners[t, 3, 2] - corners[t, 0, 2]
    px, py, pz = points[i, 0] - corners[t, 0, 0], points[i, 1] - corners[t, 0, 1], points[i, 2] - corners[t, 0, 2]
    volume = ux * (vy * wz - vz * wy) + uy * (vz * wx - vx * wz) + uz * (vx * wy - vy * wx)
    if volume == 0.0:
        return -1.0
    weights[1] = (px * (vy * wz - vz * wy) + py * (vz * wx - vx * wz) + pz * (vx * wy - vy * wx)) / volume
    weights[2] = (ux * (py * wz - pz * wy) + uy * (pz * wx - px * wz) + uz * (px * wy - py * wx)) / volume
    weights[3] = (ux * (vy * pz - vz * py) + uy * (vz * px - vx * pz) + uz * (vx * py - vy * px)) / volume
    weights[0] = 1.0 - weights[1] - weights[2] - weights[3]
    least: float = min(min(weights[0], weights[1]), min(weights[2], weights[3]))
    return least
