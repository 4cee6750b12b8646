"""Distance from points to a mesh, and the smallest gap between two meshes; exact minima in float64."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.chunks import in_chunks
from core.geometry.disc_bounds import between_discs, disc_bounds
from core.geometry.face_tree import FaceTree, faces_of_leaf
from core.geometry.triangle_distance import closest_on_triangle, nearer
from core.mesh import Faces, Mesh, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

STACK = 256  # two trees over 2^31 faces each need less


def closest_points(vertices: Vertices, faces: Faces, points: Floats) -> tuple[Floats, Floats, Ints]:
    """Closest point of a mesh to each of points (N, 3) mm.

    Returns distance (N,) mm, point (N, 3) mm, face (N,). Build a `FaceTree` and use `closest_points_in` to ask twice.
    """
    return closest_points_in(FaceTree.of(vertices, faces), points)


def closest_points_in(tree: FaceTree, points: Floats) -> tuple[Floats, Floats, Ints]:
    """`closest_points` on a tree that is there already; fastest if neighbours in `points` are neighbours in space."""
    asked = np.array(points, dtype=np.float64, order="C")  # a writable copy: numba would compile again for a read-only one
    distance, point, face = np.empty(len(asked)), np.empty((len(asked), 3)), np.empty(len(asked), dtype=np.int64)

    def find(start: int, end: int) -> None:
        rows = slice(start, end)
        _find_closest(tree.boxes, tree.corners, tree.leaves, asked[rows], distance[rows], point[rows], face[rows])

    in_chunks(len(asked), find)
    return np.sqrt(distance), point, tree.face[face]


@dataclass(frozen=True, slots=True)
class Gap:
    """The place where two meshes come closest."""

    distance_mm: float
    point_mm: tuple[float, float, float]  # halfway between the two
    face_a: int
    face_b: int


def smallest_gap(a: Mesh, b: Mesh) -> tuple[float, tuple[float, float, float]]:
    """Smallest distance between two surfaces in mm, 0 if they meet, and the point halfway between the closest places.

    Whether they meet is decided here in floating point: `core.geometry.exact_intersection` decides it exactly.
    """
    gap = smallest_gap_between(FaceTree.of(a.vertices, a.faces), FaceTree.of(b.vertices, b.faces))
    return gap.distance_mm, gap.point_mm


def smallest_gap_between(a: FaceTree, b: FaceTree) -> Gap:
    """`smallest_gap` on trees that are there already, with the closest faces."""
    point, found = np.empty(3), np.zeros(2, dtype=np.int64)
    discs = disc_bounds(a), disc_bounds(b)
    squared: float = _find_gap(a.boxes, discs[0], a.corners, a.leaves, b.boxes, discs[1], b.corners, b.leaves, point, found)
    place = (float(point[0]), float(point[1]), float(point[2]))
    return Gap(math.sqrt(squared), place, int(a.face[found[0]]), int(b.face[found[1]]))


@njit(cache=True, nogil=True)
def _to_box(px: float, py: float, pz: float, boxes: Floats, node: int) -> float:
    """Squared distance from a point to a node's box."""
    dx = max(boxes[node, 0] - px, 0.0, px - boxes[node, 3])
    dy = max(boxes[node, 1] - py, 0.0, py - boxes[node, 4])
    dz = max(boxes[node, 2] - pz, 0.0, pz - boxes[node, 5])
    squared: float = dx * dx + dy * dy + dz * dz
    return squared


@njit(cache=True, nogil=True)
def _find_closest(
    boxes: Floats, corners: Floats, leaves: int, points: Floats, distance: Floats, point: Floats, face: Ints
) -> None:
    """Fill distance (N,) squared, point (N, 3), face (N,) in tree order."""
    stack, bound = np.empty(STACK, np.int64), np.empty(STACK)
    count, last = len(corners), 0
    for i in range(len(points)):
        px, py, pz = points[i, 0], points[i, 1], points[i, 2]
        # the face closest to the point before is a good first guess
        best, x, y, z = closest_on_triangle(px, py, pz, corners, last)
        stack[0], bound[0], top = 0, 0.0, 1
        while top > 0:
            top -= 1
            if bound[top] >= best:
                continue
            node = stack[top]
            if node >= leaves - 1:
                for candidate in range(*faces_of_leaf(node, leaves, count)):
                    found, cx, cy, cz = closest_on_triangle(px, py, pz, corners, candidate)
                    if found < best:
                        best, x, y, z, last = found, cx, cy, cz, candidate
                continue
            near, far = 2 * node + 1, 2 * node + 2
            to_near, to_far = _to_box(px, py, pz, boxes, near), _to_box(px, py, pz, boxes, far)
            if to_far < to_near:
                near, far, to_near, to_far = far, near, to_far, to_near
            stack[top], bound[top] = far, to_far
            stack[top + 1], bound[top + 1] = near, to_near
            top += 2
        distance[i], point[i, 0], point[i, 1], point[i, 2], face[i] = best, x, y, z, last


@njit(cache=True, nogil=True)
def _between_nodes(
    boxes_a: Floats, discs_a: Floats, node_a: int, boxes_b: Floats, discs_b: Floats, node_b: int, best: float
) -> float:
    """Lower bound of the squared distance of two nodes' faces; no effort beyond `best`."""
    total = 0.0
    for axis in range(3):
        apart = max(boxes_a[node_a, axis] - boxes_b[node_b, axis + 3], boxes_b[node_b, axis] - boxes_a[node_a, axis + 3])
        if apart > 0.0:
            total += apart * apart
    if total < best:
        total = max(total, between_discs(discs_a, node_a, discs_b, node_b))
    if total < best:
        total = max(total, between_discs(discs_b, node_b, discs_a, node_a))
    return total


@njit(cache=True, nogil=True)
def _size(boxes: Floats, node: int) -> float:
    """Squared diagonal of a node's box."""
    dx, dy, dz = boxes[node, 3] - boxes[node, 0], boxes[node, 4] - boxes[node, 1], boxes[node, 5] - boxes[node, 2]
    size: float = dx * dx + dy * dy + dz * dz
    return size


@njit(cache=True, nogil=True)
def _find_gap(
    boxes_a: Floats,
    discs_a: Floats,
    corners_a: Floats,
    leaves_a: int,
    boxes_b: Floats,
    discs_b: Floats,
    corners_b: Floats,
    leaves_b: int,
    point: Floats,
    found: Ints,
) -> float:
    """Squared gap; point (3,) and the faces in tree order found (2,) are filled. Depth first, nearest boxes first."""
    stack_a, stack_b, bound = np.empty(STACK, np.int64), np.empty(STACK, np.int64), np.empty(STACK)
    heights = np.empty((2, 3))
    count_a, count_b, best = len(corners_a), len(corners_b), np.inf
    stack_a[0], stack_b[0], bound[0], top = 0, 0, 0.0, 1
    while top > 0 and best > 0.0:
        top -= 1
        if bound[top] >= best:
            continue
        a, b = stack_a[top], stack_b[top]
        inner_a, inner_b = a < leaves_a - 1, b < leaves_b - 1
        if not inner_a and not inner_b:
            for face_a in range(*faces_of_leaf(a, leaves_a, count_a)):
                for face_b in range(*faces_of_leaf(b, leaves_b, count_b)):
                    nearest = nearer(corners_a, face_a, corners_b, face_b, best, heights, point)
                    if nearest < best:
                        best = nearest
                        found[0], found[1] = face_a, face_b
            continue
        if inner_a and (not inner_b or _size(boxes_a, a) > _size(boxes_b, b)):
            near_a, near_b, far_a, far_b = 2 * a + 1, b, 2 * a + 2, b
        else:
            near_a, near_b, far_a, far_b = a, 2 * b + 1, a, 2 * b + 2
        to_near = _between_nodes(boxes_a, discs_a, near_a, boxes_b, discs_b, near_b, best)
        to_far = _between_nodes(boxes_a, discs_a, far_a, boxes_b, discs_b, far_b, best)
        if to_far < to_near:
            near_a, near_b, far_a, far_b, to_near, to_far = far_a, far_b, near_a, near_b, to_far, to_near
        stack_a[top], stack_b[top], bound[top] = far_a, far_b, to_far
        stack_a[top + 1], stack_b[top + 1], bound[top + 1] = near_a, near_b, to_near
        top += 2
    return best
