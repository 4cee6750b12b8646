"""A tree of boxes over the faces of a mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.mesh import Faces, Vertices

FACES_PER_LEAF = 2


@dataclass(frozen=True, eq=False, slots=True)
class FaceTree:
    """A complete binary tree; node n has children 2n+1 and 2n+2, the last `leaves` nodes are the leaves.

    boxes: (2 leaves - 1, 6) mm, lowest x y z then highest. corners: (F, 3, 3) mm in the order of the tree.
    face: (F,) the mesh's number of each face of the tree. Leaf k holds faces k F // leaves to (k + 1) F // leaves - 1.
    """

    boxes: NDArray[np.float64]
    corners: NDArray[np.float64]
    face: NDArray[np.int64]
    leaves: int

    @classmethod
    def of(cls, vertices: Vertices, faces: Faces) -> FaceTree:
        """Build over vertices (V, 3) mm and faces (F, 3), F >= 1; O(F log F), the same tree for the same input."""
        corners = vertices[faces]
        leaves = 1
        while leaves * FACES_PER_LEAF < len(faces):
            leaves *= 2
        order = np.arange(len(faces))
        _sort_by_median_cuts(corners.mean(axis=1), order, leaves)
        ordered = np.ascontiguousarray(corners[order])
        return cls(_boxes(ordered, leaves), ordered, order, leaves)


@njit(cache=True, nogil=True)
def _sort_by_median_cuts(centres: NDArray[np.float64], order: NDArray[np.int64], leaves: int) -> None:
    """Order faces so that every node of the tree holds a run of them, halved across the longest side of its centres.

    centres: (F, 3). order: (F,) int64, sorted in place.
    """
    count = len(order)
    low, high = np.empty(3), np.empty(3)
    nodes = 1
    while nodes < leaves:
        for node in range(nodes):
            start, end = node * count // nodes, (node + 1) * count // nodes
            low[:], high[:] = np.inf, -np.inf
            for i in range(start, end):
                for axis in range(3):
                    value = centres[order[i], axis]
                    low[axis], high[axis] = min(low[axis], value), max(high[axis], value)
            axis = 0
            for other in range(1, 3):
                if high[other] - low[other] > high[axis] - low[axis]:
                    axis = other
            # quickselect (Hoare): everything before `middle` is not above anything from `middle` on
            middle, left, right = (2 * node + 1) * count // (2 * nodes), start, end - 1
            while left < right:
                pivot = centres[order[(left + right) // 2], axis]
                i, j = left, right
                while i <= j:
                    while centres[order[i], axis] < pivot:
                        i += 1
                    while centres[order[j], axis] > pivot:
                        j -= 1
                    if i <= j:
                        order[i], order[j] = order[j], order[i]
                        i += 1
                        j -= 1
                if middle <= j:
                    right = j
                elif middle >= i:
                    left = i
                else:
                    break
        nodes *= 2


def _boxes(corners: NDArray[np.float64], leaves: int) -> NDArray[np.float64]:
    """Boxes of all nodes from the corners in tree order, bottom up."""
    starts = np.arange(leaves) * len(corners) // leaves
    boxes: NDArray[np.float64] = np.empty((2 * leaves - 1, 6))
    boxes[leaves - 1 :, :3] = np.minimum.reduceat(corners.min(axis=1), starts)
    boxes[leaves - 1 :, 3:] = np.maximum.reduceat(corners.max(axis=1), starts)
    level = leaves
    while level > 1:
        children = boxes[level - 1 : 2 * level - 1].reshape(-1, 2, 6)
        level //= 2
        boxes[level - 1 : 2 * level - 1, :3] = children[:, :, :3].min(axis=1)
        boxes[level - 1 : 2 * level - 1, 3:] = children[:, :, 3:].max(axis=1)
    return boxes
