"""Does the surface stay near the original, and the original near the surface? Asked for the faces of one collapse."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.decimation.kernel import kernel
from core.geometry.triangle_distance import closest_on_triangle

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]


class Nearness(NamedTuple):
    """asked: False asks nothing. limits_mm: (V,) how far the surface may be around each vertex; a vertex that takes another in
    gets the lower of both. boxes, corners, leaves: the `FaceTree` of the original. members: (V, 3) its vertices.

    corner: (1, 3, 3) and stack: (256,) are scratch.
    """

    asked: bool
    limits_mm: Floats
    boxes: Floats
    corners: Floats
    leaves: int
    members: Floats
    corner: Floats
    stack: Ints


ANYWHERE = Nearness(
    False, np.empty(0), np.empty((0, 6)), np.empty((0, 3, 3)), 0, np.empty((0, 3)), np.empty((1, 3, 3)), np.empty(256, np.int64)
)


@kernel
def stays_near(points: Floats, next_member: Int32s, a: int, b: int, count: int, rim: Int32s, nearness: Nearness) -> bool:
    """True if the new faces (a, rim[i, 0], rim[i, 1]) keep to the limit both ways.

    b: -1 if a alone moved. Asked are, of the new faces, the vertex, the middles of the sides that lead to it and of the
    faces; of the original, the vertices that were merged into a and b.
    """
    limit = min(nearness.limits_mm[a], nearness.limits_mm[b if b >= 0 else a]) ** 2
    x, y, z = points[a, 0], points[a, 1], points[a, 2]
    if not _is_near(x, y, z, limit, nearness):
        return False
    for i in range(count):
        p, q = rim[i, 0], rim[i, 1]
        if not _is_near(0.5 * (x + points[p, 0]), 0.5 * (y + points[p, 1]), 0.5 * (z + points[p, 2]), limit, nearness):
            return False
        u = (x + points[p, 0] + points[q, 0]) / 3.0
        v = (y + points[p, 1] + points[q, 1]) / 3.0
        w = (z + points[p, 2] + points[q, 2]) / 3.0
        if not _is_near(u, v, w, limit, nearness):
            return False
    for end in (a, b):
        member = end
        while member >= 0:
            near = False
            for i in range(count):
                for axis in range(3):
                    nearness.corner[0, 0, axis] = points[a, axis]
                    nearness.corner[0, 1, axis] = points[rim[i, 0], axis]
                    nearness.corner[0, 2, axis] = points[rim[i, 1], axis]
                squared, _x, _y, _z = closest_on_triangle(
                    nearness.members[member, 0], nearness.members[member, 1], nearness.members[member, 2], nearness.corner, 0
                )
                if squared <= limit:
                    near = True
                    break
            if not near:
                return False
            member = next_member[member]
    return True


@kernel
def _is_near(x: float, y: float, z: float, limit: float, nearness: Nearness) -> bool:
    """True if the original has a point within sqrt(limit)."""
    boxes, corners, stack, count = nearness.boxes, nearness.corners, nearness.stack, len(nearness.corners)
    stack[0], top = 0, 1
    while top > 0:
        top -= 1
        node = stack[top]
        dx = max(boxes[node, 0] - x, 0.0, x - boxes[node, 3])
        dy = max(boxes[node, 1] - y, 0.0, y - boxes[node, 4])
        dz = max(boxes[node, 2] - z, 0.0, z - boxes[node, 5])
        if dx * dx + dy * dy + dz * dz > limit:
            continue
        if node < nearness.leaves - 1:
            stack[top], stack[top + 1] = 2 * node + 2, 2 * node + 1
            top += 2
            continue
        leaf = node - nearness.leaves + 1
        for face in range(leaf * count // nearness.leaves, (leaf + 1) * count // nearness.leaves):
            squared, _x, _y, _z = closest_on_triangle(x, y, z, corners, face)
            if squared <= limit:
                return True
    return False
