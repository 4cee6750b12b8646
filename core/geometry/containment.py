"""Inside or outside of closed surfaces, by exactly counted crossings of a ray."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.exact_predicates import Signs, orient2d, orient3d
from core.geometry.face_tree import FaceTree

Ints = NDArray[np.int64]
Points = NDArray[np.float64]

POINTS_AT_ONCE = 4096  # bounds the memory for candidates


def find_crossings(tree: FaceTree, points: Points) -> tuple[Ints, Ints]:
    """Faces crossed by the rays that start at points (N, 3) mm and run towards +x.

    Returns (K,) numbers of the points and (K,) numbers of the faces they see, pair by pair.
    Exact: a ray through an edge or corner is decided as if the point were moved by (0, ε, ε²), so each passage through
    a closed surface is counted once. A face on which the point itself lies is not ahead of it.

    Source: Edelsbrunner & Mücke 1990, simulation of simplicity.
    """
    parts = [
        _find_crossings(tree, points[start : start + POINTS_AT_ONCE], start) for start in range(0, len(points), POINTS_AT_ONCE)
    ]
    if not parts:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    return np.concatenate([point for point, _ in parts]), np.concatenate([face for _, face in parts])


def _find_crossings(tree: FaceTree, points: Points, offset: int) -> tuple[Ints, Ints]:
    """`find_crossings` for a few points; `offset` is the number of the first."""
    point, face = _find_candidates(tree, points)
    p = points[point]
    corners = tree.corners[face]
    turns = np.column_stack([_turn(corners[:, i, 1:], corners[:, (i + 1) % 3, 1:], p[:, 1:]) for i in range(3)])
    through = (turns != 0).all(axis=1) & (turns[:, 0] == turns[:, 1]) & (turns[:, 1] == turns[:, 2])
    point, face, p, corners, turn = point[through], face[through], p[through], corners[through], turns[through, 0]
    # seen from +x the face turns counter-clockwise if turn > 0; the point is behind the face if it sees it turn the other way
    side = orient3d(corners[:, 0], corners[:, 1], corners[:, 2], p) * turn
    ahead = side < 0
    return point[ahead] + offset, tree.face[face[ahead]]


def is_inside(tree: FaceTree, points: Points) -> NDArray[np.bool_]:
    """True where a point (N, 3) lies inside the closed surface of the tree: an odd number of crossings.

    The parity asks nothing of the orientation of faces; cavities are outside. Points on the surface are not decided
    meaningfully: measure the distance first.
    """
    point, _face = find_crossings(tree, points)
    inside: NDArray[np.bool_] = np.bincount(point, minlength=len(points)) % 2 == 1
    return inside


def _find_candidates(tree: FaceTree, points: Points) -> tuple[Ints, Ints]:
    """Pairs (point, face in tree order) whose boxes the rays meet; walks the tree level by level for all points at once."""
    point, node = np.arange(len(points)), np.zeros(len(points), dtype=np.int64)
    while True:
        box, p = tree.boxes[node], points[point]
        met = (box[:, 3] >= p[:, 0]) & (box[:, 1:3] <= p[:, 1:]).all(axis=1) & (box[:, 4:6] >= p[:, 1:]).all(axis=1)
        point, node = point[met], node[met]
        # the tree is complete: all nodes of a level are leaves, or none
        if len(node) == 0 or node[0] >= tree.leaves - 1:
            break
        point, node = np.repeat(point, 2), (2 * node[:, None] + np.array([1, 2])).ravel()
    leaf, count = node - (tree.leaves - 1), len(tree.corners)
    start, end = leaf * count // tree.leaves, (leaf + 1) * count // tree.leaves
    width = end - start
    first = np.repeat(np.cumsum(width) - width, width)
    return np.repeat(point, width), np.repeat(start, width) + np.arange(width.sum()) - first


def _turn(a: Points, b: Points, p: Points) -> Signs:
    """orient2d(a, b, p) with p moved by (ε, ε²): 0 only where a equals b. Each (N, 2)."""
    turn = orient2d(a, b, p)
    # the change of the determinant with p is (a_y - b_y) along the first axis and (b_x - a_x) along the second
    tied = turn == 0
    turn[tied] = np.sign(a[tied, 1] - b[tied, 1]).astype(np.int8)
    tied = turn == 0
    turn[tied] = np.sign(b[tied, 0] - a[tied, 0]).astype(np.int8)
    return turn
