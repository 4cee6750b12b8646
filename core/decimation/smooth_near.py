"""The local smoothing of the thesis (3.4.4): vertices around collapses go towards the middle of their neighbours."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.decimation.box_tree import widen
from core.decimation.collapse import Guards, Scratch
from core.decimation.kernel import kernel
from core.decimation.nearness import Nearness, stays_near
from core.decimation.placement import place
from core.decimation.room import Obstacles, has_room
from core.decimation.star import following, gather_star, preceding
from core.decimation.state import GONE, State
from core.decimation.triangle import triangle

Flags = NDArray[np.bool_]

HOLD = 0.003  # pull towards the middle of the neighbours, against the planes of the former faces
TURN_COSINE = 0.5  # a face turns by less than 60 degrees


@njit(cache=True, nogil=True)
def spread_to_neighbours(state: State) -> None:
    """Mark the neighbours of dirty vertices dirty: the second ring of the thesis."""
    marked = state.dirty.copy()
    for corner in range(len(state.ids)):
        if state.ids[corner] != GONE and marked[state.ids[corner]]:
            state.dirty[state.ids[following(corner)]] = True


@kernel
def smooth_dirty(state: State, weight: float, guards: Guards, obstacles: Obstacles, nearness: Nearness, scratch: Scratch) -> int:
    """Move dirty vertices by `weight` of the way to the middle of their neighbours, along the surface; returns how many moved.

    The way is taken within the tangent plane, then the vertex's quadric pulls it back onto the surface it stands for, so
    nothing shrinks. A vertex stays where it is unless the worst of its faces gets better, and under all guards of a collapse.
    """
    moved = 0
    for vertex in range(len(state.points)):
        if not state.dirty[vertex] or state.corner_of[vertex] == GONE or state.fixed[vertex]:
            continue
        moved += _smooth(state, vertex, weight, guards, obstacles, nearness, scratch)
    return moved


@kernel
def _smooth(
    state: State, vertex: int, weight: float, guards: Guards, obstacles: Obstacles, nearness: Nearness, scratch: Scratch
) -> bool:
    ids, points = state.ids, state.points
    count = gather_star(state.opposite, state.corner_of[vertex], scratch.star_a)
    if count < 0:
        return False
    ox, oy, oz = points[vertex, 0], points[vertex, 1], points[vertex, 2]
    cx, cy, cz, nx, ny, nz, worst = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
    for i in range(count):
        corner = scratch.star_a[i]
        face, p = corner // 3, ids[following(corner)]
        scratch.rim[i, 0], scratch.rim[i, 1] = p, ids[preceding(corner)]
        cx, cy, cz = cx + points[p, 0] - ox, cy + points[p, 1] - oy, cz + points[p, 2] - oz
        nx, ny, nz = nx + state.normals[face, 0], ny + state.normals[face, 1], nz + state.normals[face, 2]
        worst = min(worst, state.shape[face])
    share = weight / count
    cx, cy, cz = cx * share, cy * share, cz * share
    length = math.sqrt(nx * nx + ny * ny + nz * nz)
    if length > 0.0:
        along = (cx * nx + cy * ny + cz * nz) / (length * length)
        cx, cy, cz = cx - along * nx, cy - along * ny, cz - along * nz
    x, y, z = place(state.quadrics, vertex, vertex, state.origin, ox + cx, oy + cy, oz + cz, HOLD)
    x, y, z = float(np.float32(x)), float(np.float32(y)), float(np.float32(z))
    for i in range(count):
        p, q, face = scratch.rim[i, 0], scratch.rim[i, 1], scratch.star_a[i] // 3
        nx, ny, nz, _area, shape = triangle(
            x, y, z, points[p, 0], points[p, 1], points[p, 2], points[q, 0], points[q, 1], points[q, 2]
        )
        turned = nx * state.normals[face, 0] + ny * state.normals[face, 1] + nz * state.normals[face, 2] < TURN_COSINE
        if shape <= worst or turned:
            return False
        scratch.normals[i, 0], scratch.normals[i, 1], scratch.normals[i, 2], scratch.shape[i] = nx, ny, nz, shape
    scratch.token[0] += 1
    for i in range(count):
        scratch.face_stamp[scratch.star_a[i] // 3] = scratch.token[0]
    points[vertex, 0], points[vertex, 1], points[vertex, 2] = x, y, z
    fits = has_room(
        points, ids, state.normals, state.boxes,
        obstacles, guards.own_mm, guards.thorough, scratch.token[0],
        scratch.face_stamp, vertex, count, scratch.rim, scratch.normals, scratch.room,
    )  # fmt: skip
    if fits and nearness.asked:
        fits = stays_near(points, state.next_member, vertex, GONE, count, scratch.rim, nearness)
    if not fits:
        points[vertex, 0], points[vertex, 1], points[vertex, 2] = ox, oy, oz
        return False
    for i in range(count):
        face = scratch.star_a[i] // 3
        for axis in range(3):
            state.normals[face, axis] = scratch.normals[i, axis]
        state.shape[face] = scratch.shape[i]
        widen(points, ids, state.boxes, face)
    return True
