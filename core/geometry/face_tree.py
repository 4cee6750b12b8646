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
        return cls.of_corners(vertices[faces])

    @classmethod
    def of_corners(cls, corners: NDArray[np.float64]) -> FaceTree:
        """`of` for corners (F, 3, 3) mm; three points of anything else give boxes around it."""
        leaves = 1
        while leaves * FACES_PER_LEAF < len(corners):
            leaves *= 2
        order = np.arange(len(corners))
        _sort_by_median_cuts(corners.sum(axis=1), order, leaves)
        ordered = np.ascontiguousarray(corners[order])
        boxes = np.empty((2 * leaves - 1, 6))
        fit_boxes(ordered, leaves, boxes)
        return cls(boxes, ordered, order, leaves)

    def moved(self, vertices: Vertices, faces: Faces) -> FaceTree:
        """The same tree around the same faces (F, 3), vertices (V, 3) mm elsewhere; O(F). Good if they moved little."""
        corners = vertices[faces[self.face]]
        boxes = np.empty_like(self.boxes)
        fit_boxes(corners, self.leaves, boxes)
        return FaceTree(boxes, corners, self.face, self.leaves)


@njit(cache=True, nogil=True)
def _sort_by_median_cuts(centres: NDArray[np.float64], order: NDArray[np.int64], leaves: int) -> None:
    """Order faces so that every node of the tree holds a run of them, halved across the longest side of its centres.

    centres: (F, 3), on any scale. order: (F,) int64, sorted in place.
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


@njit(cache=True, nogil=True)
def fit_boxes(corners: NDArray[np.float64], leaves: int, boxes: NDArray[np.float64]) -> None:
    """Boxes of all nodes, (2 leaves - 1, 6), from the corners in tree order, bottom up."""
    for leaf in range(leaves):
        fit_leaf(corners, leaves, leaf, boxes)
    for node in range(leaves - 2, -1, -1):
        fit_parent(boxes, node)


@njit(cache=True, nogil=True)
def push_children(stack: NDArray[np.int64], top: int, node: int) -> int:
    """Put both children of an inner node onto the stack of nodes still to be looked at; its new height."""
    stack[top], stack[top + 1] = 2 * node + 1, 2 * node + 2
    return top + 2


@njit(cache=True, nogil=True)
def faces_of_leaf(node: int, leaves: int, count: int) -> tuple[int, int]:
    """The first face in tree order that the leaf `node` holds of `count`, and the one after its last."""
    leaf = node - leaves + 1
    return leaf * count // leaves, (leaf + 1) * count // leaves


@njit(cache=True, nogil=True)
def fit_leaf(corners: NDArray[np.float64], leaves: int, leaf: int, boxes: NDArray[np.float64]) -> None:
    """Box of a leaf around its faces."""
    count = len(corners)
    for axis in range(3):
        low, high = np.inf, -np.inf
        for place in range(*faces_of_leaf(leaves - 1 + leaf, leaves, count)):
            for corner in range(3):
                low, high = min(low, corners[place, corner, axis]), max(high, corners[place, corner, axis])
        boxes[leaves - 1 + leaf, axis], boxes[leaves - 1 + leaf, axis + 3] = low, high


@njit(cache=True, nogil=True)
def fit_parent(boxes: NDArray[np.float64], node: int) -> bool:
    """Box of a node around its children's; True if it changed."""
    changed = False
    for axis in range(3):
        low = min(boxes[2 * node + 1, axis], boxes[2 * node + 2, axis])
        high = max(boxes[2 * node + 1, axis + 3], boxes[2 * node + 2, axis + 3])
        changed = changed or low != boxes[node, axis] or high != boxes[node, axis + 3]
        boxes[node, axis], boxes[node, axis + 3] = low, high
    return changed
