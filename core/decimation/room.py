"""Is there room for the new faces around a vertex? Not nearer to others than allowed, no fold, no crossing."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.decimation.box_tree import STACK, find_in_box
from core.decimation.kernel import kernel
from core.geometry.clearance import pair_is_crowded
from core.geometry.triangle_distance import nearer

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]

OPEN_COSINE = 0.3  # faces within about 70 degrees of one direction cannot cross: no pair of them is asked
FOUND = 4096  # faces near one star; more of them, and the collapse is refused


class Obstacles(NamedTuple):
    """Other surfaces, as one `FaceTree`, and the squared distance to keep from them; no boxes if there are none."""

    boxes: Floats
    corners: Floats
    leaves: int
    gap_squared: float


NO_OBSTACLES = Obstacles(np.empty((0, 6)), np.empty((0, 3, 3)), 0, 0.0)


class RoomScratch(NamedTuple):
    """The caller's scratch; corners (2, 3, 3) and ids (2, 3) hold one pair at a time."""

    box: Floats
    stack: Ints
    found: Ints
    corners: Floats
    ids: Int32s
    heights: Floats
    point: Floats

    @classmethod
    def new(cls) -> RoomScratch:
        """Fresh arrays."""
        return cls(
            np.empty(6), np.empty(STACK, np.int64), np.empty(FOUND, np.int64), np.empty((2, 3, 3)),
            np.empty((2, 3), np.int32), np.empty((2, 3)), np.empty(3),
        )  # fmt: skip


@kernel
def has_room(
    points: Floats,
    ids: Int32s,
    normals: Floats,
    boxes: Floats,
    obstacles: Obstacles,
    own_mm: float,
    thorough: bool,
    token: int,
    face_stamp: Ints,
    centre: int,
    count: int,
    rim: Int32s,
    new_normals: Floats,
    scratch: RoomScratch,
) -> bool:
    """True if `count` new faces (centre, rim[i, 0], rim[i, 1]) keep clear of all faces not stamped with token, and of obstacles.

    rim: (>= count, 2) vertices, points of all in place. new_normals: (>= count, 3) unit. thorough: ask every pair of faces
    whose boxes meet, not only where surfaces face each other.
    """
    box = scratch.box
    for axis in range(3):
        low = high = points[centre, axis]
        for i in range(count):
            value = points[rim[i, 0], axis]
            low, high = min(low, value), max(high, value)
        box[axis], box[axis + 3] = low - own_mm, high + own_mm
    nx, ny, nz = 0.0, 0.0, 0.0
    for i in range(count):
        nx, ny, nz = nx + new_normals[i, 0], ny + new_normals[i, 1], nz + new_normals[i, 2]
    length = np.sqrt(nx * nx + ny * ny + nz * nz)
    if length == 0.0:
        return False
    nx, ny, nz = nx / length, ny / length, nz / length
    suspicious = thorough
    for i in range(count):
        if new_normals[i, 0] * nx + new_normals[i, 1] * ny + new_normals[i, 2] * nz < OPEN_COSINE:
            suspicious = True
    kept = 0
    near = find_in_box(points, ids, boxes, box, scratch.stack, scratch.found)
    if near < 0:
        return False
    for k in range(near):
        face = scratch.found[k]
        if face_stamp[face] == token:
            continue
        scratch.found[kept] = face
        kept += 1
        if normals[face, 0] * nx + normals[face, 1] * ny + normals[face, 2] * nz < OPEN_COSINE:
            suspicious = True
    if suspicious and _is_crowded(points, ids, centre, count, rim, kept, own_mm, scratch):
        return False
    return len(obstacles.boxes) == 0 or not _meets_obstacle(points, centre, count, rim, obstacles, scratch)


@kernel
def _load(points: Floats, row: int, a: int, b: int, c: int, scratch: RoomScratch) -> None:
    scratch.ids[row, 0], scratch.ids[row, 1], scratch.ids[row, 2] = a, b, c
    for axis in range(3):
        scratch.corners[row, 0, axis] = points[a, axis]
        scratch.corners[row, 1, axis] = points[b, axis]
        scratch.corners[row, 2, axis] = points[c, axis]


@kernel
def _is_crowded(
    points: Floats, ids: Int32s, centre: int, count: int, rim: Int32s, kept: int, own_mm: float, scratch: RoomScratch
) -> bool:
    """True if a new face crowds one of the faces found, or another new one."""
    limit = own_mm * own_mm
    for i in range(count):
        _load(points, 0, centre, rim[i, 0], rim[i, 1], scratch)
        for k in range(kept):
            face = scratch.found[k]
            _load(points, 1, ids[3 * face], ids[3 * face + 1], ids[3 * face + 2], scratch)
            if _apart(scratch.corners, own_mm):
                continue
            if pair_is_crowded(scratch.corners, scratch.ids, 0, 1, limit, scratch.heights, scratch.point):
                return True
        for k in range(i + 1, count):
            _load(points, 1, centre, rim[k, 0], rim[k, 1], scratch)
            if pair_is_crowded(scratch.corners, scratch.ids, 0, 1, limit, scratch.heights, scratch.point):
                return True
    return False


@kernel
def _apart(corners: Floats, margin: float) -> bool:
    """True if the boxes of both faces are further apart than margin."""
    for axis in range(3):
        a, b, c = corners[0, 0, axis], corners[0, 1, axis], corners[0, 2, axis]
        p, q, r = corners[1, 0, axis], corners[1, 1, axis], corners[1, 2, axis]
        if min(a, b, c) - margin > max(p, q, r) or max(a, b, c) + margin < min(p, q, r):
            return True
    return False


@kernel
def _meets_obstacle(points: Floats, centre: int, count: int, rim: Int32s, obstacles: Obstacles, scratch: RoomScratch) -> bool:
    """True if a new face comes nearer to an obstacle than the gap."""
    gap = np.sqrt(obstacles.gap_squared)
    box, boxes, leaves, faces = scratch.box, obstacles.boxes, obstacles.leaves, len(obstacles.corners)
    for i in range(count):
        _load(points, 0, centre, rim[i, 0], rim[i, 1], scratch)
        for axis in range(3):
            a, b, c = scratch.corners[0, 0, axis], scratch.corners[0, 1, axis], scratch.corners[0, 2, axis]
            box[axis], box[axis + 3] = min(a, b, c) - gap, max(a, b, c) + gap
        scratch.stack[0], top = 0, 1
        while top > 0:
            top -= 1
            node = scratch.stack[top]
            if boxes[node, 0] > box[3] or boxes[node, 1] > box[4] or boxes[node, 2] > box[5]:
                continue
            if boxes[node, 3] < box[0] or boxes[node, 4] < box[1] or boxes[node, 5] < box[2]:
                continue
            if node < leaves - 1:
                scratch.stack[top], scratch.stack[top + 1] = 2 * node + 2, 2 * node + 1
                top += 2
                continue
            leaf = node - leaves + 1
            for other in range(leaf * faces // leaves, (leaf + 1) * faces // leaves):
                found = nearer(
                    scratch.corners, 0, obstacles.corners, other, obstacles.gap_squared, scratch.heights, scratch.point
                )
                if found < obstacles.gap_squared:
                    return True
    return False
