"""Which faces of a moving surface come too close to others: the invariant that every accepted step keeps."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.chunks import in_chunks
from core.geometry.face_tree import FaceTree, faces_of_leaf, fit_boxes, fit_leaf, fit_parent, push_children
from core.geometry.triangle_distance import between_sides, closest_on_triangle, nearer
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEIGHBOUR_SHARE = 0.02  # faces that meet in one corner keep this share of their shortest side apart
FACES_PER_LEAF = 2
FEW = 8  # leaves per moved face above which boxes are followed one by one
FOLD_COSINE = 0.9957  # neighbours across an edge must open by more than 5.3 degrees


@dataclass(frozen=True, eq=False, slots=True)
class Clearance:
    """The distances a moving surface keeps.

    gap_mm: to the obstacles. own_mm: between its own faces that share no corner. obstacles: surfaces that do not move.
    """

    gap_mm: float
    own_mm: float
    obstacles: tuple[FaceTree, ...]


class MovingSurface:
    """A surface whose vertices move; the tree over its faces is cut once and only corners and boxes follow."""

    def __init__(self, vertices: Vertices, faces: Faces, order: Ints | None = None) -> None:
        """Cut the tree over the surface as it is now: vertices (V, 3) mm, faces (F, 3); or take the order of a cut (F,)."""
        self._face = FaceTree.of(vertices, faces).face if order is None else order
        self._ids = np.ascontiguousarray(faces[self._face])
        self._place = np.empty(len(faces), dtype=np.int64)
        self._place[self._face] = np.arange(len(faces))
        self._leaves = 1 << max(0, (len(faces) // FACES_PER_LEAF - 1).bit_length())
        self._corners = np.empty((len(faces), 3, 3))
        self._boxes = np.empty((2 * self._leaves - 1, 6))
        _follow(vertices, self._ids, np.arange(len(faces)), self._corners, self._boxes, self._leaves)

    def edited(self, vertices: Vertices, faces: Faces, former: Ints) -> MovingSurface:
        """The tree of a surface most of whose faces are still there; former (G,): the old number of each face."""
        number = np.full(len(self._face), -1, dtype=np.int64)
        number[former] = np.arange(len(former))
        order = number[self._face]
        return MovingSurface(vertices, faces, order[order >= 0])

    def find_crowded(self, vertices: Vertices, moved: Ints, clearance: Clearance) -> Ints:
        """Faces that break the clearance in a pair with one of the `moved` faces (M,); sorted face numbers.

        `moved` must name every face one of whose vertices differs from the call before. Too close for float64 to tell
        counts as broken, so what is accepted here is confirmed, never refuted, by the exact test at the end.
        """
        places = self._place[moved]
        _follow(vertices, self._ids, places, self._corners, self._boxes, self._leaves)
        wanted = np.zeros(len(self._face), dtype=np.bool_)
        wanted[places] = True
        crowded = np.zeros(len(self._face), dtype=np.bool_)

        def mark(start: int, end: int) -> None:
            some = places[start:end]
            _mark_own(self._boxes, self._corners, self._leaves, self._ids, some, wanted, clearance.own_mm, crowded)
            for other in clearance.obstacles:
                _mark_near(self._corners, some, other.boxes, other.corners, other.leaves, clearance.gap_mm, crowded)

        in_chunks(len(places), mark)  # chunks may mark the same face; they only ever set it
        return np.sort(self._face[crowded])


@njit(cache=True, nogil=True)
def _follow(vertices: Vertices, ids: NDArray[np.int32], places: Ints, corners: Floats, boxes: Floats, leaves: int) -> None:
    """Bring the corners of some faces, and all boxes, to where the vertices are."""
    for place in places:
        for corner in range(3):
            for axis in range(3):
                corners[place, corner, axis] = vertices[ids[place, corner], axis]
    if len(places) * FEW > leaves:
        fit_boxes(corners, leaves, boxes)
        return
    count = len(corners)
    for place in places:
        fit_leaf(corners, leaves, ((place + 1) * leaves - 1) // count, boxes)
    for place in places:
        node = leaves - 1 + ((place + 1) * leaves - 1) // count
        # a box that stays needs nothing above it: whatever else changes below climbs on its own
        while node > 0 and fit_parent(boxes, (node - 1) // 2):
            node = (node - 1) // 2


@njit(cache=True, nogil=True)
def _box_of(corners: Floats, face: int, margin: float, box: Floats) -> None:
    """The face's box, widened by margin, into box (6,)."""
    for axis in range(3):
        a, b, c = corners[face, 0, axis], corners[face, 1, axis], corners[face, 2, axis]
        box[axis] = min(a, b, c) - margin
        box[axis + 3] = max(a, b, c) + margin


@njit(cache=True, nogil=True)
def _apart(box: Floats, boxes: Floats, node: int) -> bool:
    """True if the box misses the node's."""
    if box[0] > boxes[node, 3] or box[1] > boxes[node, 4] or box[2] > boxes[node, 5]:
        return True
    below: bool = box[3] < boxes[node, 0] or box[4] < boxes[node, 1] or box[5] < boxes[node, 2]
    return below


@njit(cache=True, nogil=True)
def _outside(box: Floats, corners: Floats, face: int) -> bool:
    """True if the box misses the face's own box."""
    for axis in range(3):
        a, b, c = corners[face, 0, axis], corners[face, 1, axis], corners[face, 2, axis]
        if box[axis] > max(a, b, c) or box[axis + 3] < min(a, b, c):
            return True
    return False


@njit(cache=True, nogil=True)
def _mark_near(
    corners: Floats,
    asked: Ints,
    boxes: Floats,
    others: Floats,
    leaves: int,
    gap: float,
    crowded: NDArray[np.bool_],
) -> None:
    """Mark faces of `asked` closer than gap to any face of the other tree."""
    stack, box, heights, point = np.empty(256, np.int64), np.empty(6), np.empty((2, 3)), np.empty(3)
    count, limit = len(others), gap * gap
    for face in asked:
        if crowded[face]:
            continue
        _box_of(corners, face, gap, box)
        stack[0], top = 0, 1
        while top > 0:
            top -= 1
            node = stack[top]
            if _apart(box, boxes, node):
                continue
            if node < leaves - 1:
                top = push_children(stack, top, node)
                continue
            for other in range(*faces_of_leaf(node, leaves, count)):
                if _outside(box, others, other):
                    continue
                if nearer(corners, face, others, other, limit, heights, point) < limit:
                    crowded[face] = True
                    top = 0
                    break


@njit(cache=True, nogil=True)
def _mark_own(
    boxes: Floats,
    corners: Floats,
    leaves: int,
    ids: NDArray[np.int32],
    asked: Ints,
    wanted: NDArray[np.bool_],
    own: float,
    crowded: NDArray[np.bool_],
) -> None:
    """Mark both faces of every pair of the surface itself, one of them asked for, that is too close or folded."""
    stack, box, heights, point = np.empty(256, np.int64), np.empty(6), np.empty((2, 3)), np.empty(3)
    count, limit = len(corners), own * own
    for face in asked:
        _box_of(corners, face, own, box)
        stack[0], top = 0, 1
        while top > 0:
            top -= 1
            node = stack[top]
            if _apart(box, boxes, node):
                continue
            if node < leaves - 1:
                top = push_children(stack, top, node)
                continue
            for other in range(*faces_of_leaf(node, leaves, count)):
                # a pair of two asked faces is met from both sides; once is enough
                if other == face or (wanted[other] and other < face) or _outside(box, corners, other):
                    continue
                if pair_is_crowded(corners, ids, face, other, limit, heights, point):
                    crowded[face] = True
                    crowded[other] = True


@njit(cache=True, nogil=True)
def pair_is_crowded(
    corners: Floats, ids: NDArray[np.int32], face: int, other: int, limit: float, heights: Floats, point: Floats
) -> bool:
    """Two faces of one surface: by distance, or by opening where they share a corner or an edge."""
    shared, corner, other_corner, corner_sum, other_sum = 0, 0, 0, 0, 0
    for i in range(3):
        for j in range(3):
            if ids[face, i] == ids[other, j]:
                shared += 1
                corner, other_corner = i, j
                corner_sum += i
                other_sum += j
    if shared == 0:
        near: bool = nearer(corners, face, corners, other, limit, heights, point) < limit
        return near
    if shared == 1:
        spoke = min(_shortest_spoke(corners, face, corner), _shortest_spoke(corners, other, other_corner))
        reach = min(limit, NEIGHBOUR_SHARE**2 * spoke)
        if _are_parted(corners, face, corner, other, other_corner, reach):
            return False
        touching: bool = _side_is_near(corners, face, corner, other, reach) or _side_is_near(
            corners, other, other_corner, face, reach
        )
        return touching
    if shared == 2:
        folded: bool = _is_folded(corners, face, 3 - corner_sum, other, 3 - other_sum)
        return folded
    return True


@njit(cache=True, nogil=True)
def _are_parted(corners: Floats, face: int, corner: int, other: int, other_corner: int, limit: float) -> bool:
    """True if a plane through the common corner keeps the opposite sides of both faces sqrt(limit) away: the usual case.

    Its normal is the difference of the directions in which the two faces leave the corner.
    """
    wx, wy, wz = 0.0, 0.0, 0.0
    for turn in range(1, 3):
        for sign, which, tip in ((1.0, face, (corner + turn) % 3), (-1.0, other, (other_corner + turn) % 3)):
            x = corners[which, tip, 0] - corners[face, corner, 0]
            y = corners[which, tip, 1] - corners[face, corner, 1]
            z = corners[which, tip, 2] - corners[face, corner, 2]
            length = math.sqrt(x * x + y * y + z * z)
            if length == 0.0:
                return False
            wx, wy, wz = wx + sign * x / length, wy + sign * y / length, wz + sign * z / length
    margin = math.sqrt(limit * (wx * wx + wy * wy + wz * wz)) * (1.0 + 1e-9)
    for turn in range(1, 3):
        for sign, which, tip in ((1.0, face, (corner + turn) % 3), (-1.0, other, (other_corner + turn) % 3)):
            x = corners[which, tip, 0] - corners[face, corner, 0]
            y = corners[which, tip, 1] - corners[face, corner, 1]
            z = corners[which, tip, 2] - corners[face, corner, 2]
            if not sign * (x * wx + y * wy + z * wz) > margin:
                return False
    return True


@njit(cache=True, nogil=True)
def _shortest_spoke(corners: Floats, face: int, corner: int) -> float:
    """Squared length of the shorter side at a corner."""
    best = np.inf
    for turn in range(1, 3):
        end, squared = (corner + turn) % 3, 0.0
        for axis in range(3):
            squared += (corners[face, end, axis] - corners[face, corner, axis]) ** 2
        best = min(best, squared)
    return best


@njit(cache=True, nogil=True)
def _side_is_near(corners: Floats, face: int, corner: int, other: int, limit: float) -> bool:
    """True if the side of `face` opposite `corner` comes nearer than sqrt(limit) to `other`, or runs through it."""
    side = (corner + 1) % 3
    end = (corner + 2) % 3
    for tip in (side, end):
        squared, _x, _y, _z = closest_on_triangle(
            corners[face, tip, 0], corners[face, tip, 1], corners[face, tip, 2], corners, other
        )
        if squared < limit:
            return True
    for other_side in range(3):
        squared, _x, _y, _z = between_sides(corners, face, side, corners, other, other_side)
        if squared < limit:
            return True
        # an end of the other face's side above the inside of ours
        squared = _to_segment(corners, other, other_side, face, side, end)
        if squared < limit:
            return True
    through: bool = _runs_through(corners, face, side, end, other)
    return through


@njit(cache=True, nogil=True)
def _to_segment(corners: Floats, point_face: int, point: int, face: int, start: int, end: int) -> float:
    """Squared distance of a corner from a side."""
    along, length = 0.0, 0.0
    for axis in range(3):
        d = corners[face, end, axis] - corners[face, start, axis]
        along += (corners[point_face, point, axis] - corners[face, start, axis]) * d
        length += d * d
    share = min(max(along / length, 0.0), 1.0) if length > 0.0 else 0.0
    squared = 0.0
    for axis in range(3):
        foot = corners[face, start, axis] + share * (corners[face, end, axis] - corners[face, start, axis])
        squared += (corners[point_face, point, axis] - foot) ** 2
    return squared


@njit(cache=True, nogil=True)
def _runs_through(corners: Floats, face: int, start: int, end: int, other: int) -> bool:
    """True if a side of `face` pierces `other` (Möller & Trumbore 1997)."""
    px, py, pz = corners[face, start, 0], corners[face, start, 1], corners[face, start, 2]
    dx, dy, dz = corners[face, end, 0] - px, corners[face, end, 1] - py, corners[face, end, 2] - pz
    ax, ay, az = corners[other, 0, 0], corners[other, 0, 1], corners[other, 0, 2]
    ux, uy, uz = corners[other, 1, 0] - ax, corners[other, 1, 1] - ay, corners[other, 1, 2] - az
    vx, vy, vz = corners[other, 2, 0] - ax, corners[other, 2, 1] - ay, corners[other, 2, 2] - az
    hx, hy, hz = dy * vz - dz * vy, dz * vx - dx * vz, dx * vy - dy * vx
    determinant = ux * hx + uy * hy + uz * hz
    if determinant == 0.0:
        return False
    sx, sy, sz = px - ax, py - ay, pz - az
    first = (sx * hx + sy * hy + sz * hz) / determinant
    if first < 0.0 or first > 1.0:
        return False
    qx, qy, qz = sy * uz - sz * uy, sz * ux - sx * uz, sx * uy - sy * ux
    second = (dx * qx + dy * qy + dz * qz) / determinant
    if second < 0.0 or first + second > 1.0:
        return False
    along = (vx * qx + vy * qy + vz * qz) / determinant
    pierces: bool = 0.0 <= along <= 1.0
    return pierces


@njit(cache=True, nogil=True)
def _is_folded(corners: Floats, face: int, tip: int, other: int, other_tip: int) -> bool:
    """True if two faces open by less than the fold angle across their common edge."""
    start, end = (tip + 1) % 3, (tip + 2) % 3
    length, along_p, along_q = 0.0, 0.0, 0.0
    for axis in range(3):
        e = corners[face, end, axis] - corners[face, start, axis]
        length += e * e
        along_p += e * (corners[face, tip, axis] - corners[face, start, axis])
        along_q += e * (corners[other, other_tip, axis] - corners[face, start, axis])
    if length == 0.0:
        return True
    pq, pp, qq = 0.0, 0.0, 0.0
    for axis in range(3):
        e = corners[face, end, axis] - corners[face, start, axis]
        p = corners[face, tip, axis] - corners[face, start, axis] - along_p / length * e
        q = corners[other, other_tip, axis] - corners[face, start, axis] - along_q / length * e
        pq += p * q
        pp += p * p
        qq += q * q
    folded: bool = pq >= 0.0 and pq * pq >= FOLD_COSINE**2 * pp * qq
    return folded
