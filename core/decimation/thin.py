"""Take faces out, the least important first, until as many are left as wanted."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.decimation.collapse import DONE, HOLD, Guards, Scratch, collapse
from core.decimation.face_heap import entry, pop, push, replace_first
from core.decimation.nearness import Nearness
from core.decimation.placement import error, place
from core.decimation.room import Obstacles
from core.decimation.star import following, gather_star, preceding
from core.decimation.state import GONE, State

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]

SLACK = 1 << 54  # in an entry: a priority half as high again is no reason to wait
LEVEL = 1e-3  # radians; among faces flatter than about this the distance decides alone
EVEN = 1e-6  # of a side, as a distance: among collapses that change nothing, the shortest first


@njit(cache=True, nogil=True)
def thin(
    state: State,
    goal: int,
    faces: int,
    by_curvature: bool,
    guards: Guards,
    obstacles: Obstacles,
    nearness: Nearness,
    scratch: Scratch,
    counts: Ints,
) -> int:
    """Collapse sides until `goal` of the `faces` are left or nothing more may go; returns how many are left.

    The face of lowest priority goes first, by its shortest (by quadric: cheapest) side that may. A priority is computed anew
    when its face comes first, so it need not follow every change; a face that may not go waits until one next to it changes.
    counts: (8,) attempts by outcome, added to.
    """
    ids, opposite, points, normals, quadrics, origin = (
        state.ids, state.opposite, state.points, state.normals, state.quadrics, state.origin,
    )  # fmt: skip
    total = len(ids) // 3
    heap, queued = np.empty(total + 1, np.int64), np.zeros(total, np.bool_)
    bits = np.zeros(1, np.int32)
    number = bits.view(np.float32)
    costs, sides = np.empty(3), np.empty(3, np.int64)
    size = 0
    for face in range(total):
        if ids[3 * face] != GONE:
            size = push(
                heap,
                size,
                entry(
                    _priority(ids, opposite, points, normals, quadrics, origin, face, by_curvature, costs, sides),
                    face,
                    bits,
                    number,
                ),
            )
            queued[face] = True
    while faces > goal and size > 0:
        first = heap[0]
        face = first & 0xFFFFFFFF
        if ids[3 * face] == GONE:
            size = pop(heap, size)
            continue
        code = entry(
            _priority(ids, opposite, points, normals, quadrics, origin, face, by_curvature, costs, sides), face, bits, number
        )
        if code > first + SLACK:
            replace_first(heap, size, code)
            continue
        size = pop(heap, size)
        queued[face] = False
        for i in range(3):
            kept = ids[following(sides[i])]
            outcome = collapse(state, sides[i], guards, obstacles, nearness, scratch)
            counts[outcome] += 1
            if outcome != DONE:
                continue
            faces -= 2
            state.dirty[kept] = True
            around = gather_star(opposite, state.corner_of[kept], scratch.star_a)
            for k in range(around):
                corner = scratch.star_a[k]
                state.dirty[ids[following(corner)]] = True
                for near in (corner // 3, np.int64(opposite[corner]) // 3):
                    if not queued[near]:
                        priority = _priority(ids, opposite, points, normals, quadrics, origin, near, by_curvature, costs, sides)
                        size = push(heap, size, entry(priority, near, bits, number))
                        queued[near] = True
            break
    return faces


@njit(cache=True, nogil=True)
def _priority(
    ids: Int32s,
    opposite: Int32s,
    points: Floats,
    normals: Floats,
    quadrics: Floats,
    origin: Floats,
    face: int,
    by_curvature: bool,
    costs: Floats,
    sides: Ints,
) -> float:
    """Priority of a face; its sides, named by the corners opposite, go to sides (3,) in the order to try. costs: scratch.

    What a collapse changes is the distance to the former planes, root mean square, times the root of the area: mm².
    By curvature, that times the mean angle to the neighbours is the priority, and the shorter of two sides goes first.
    """
    least = np.inf
    for i in range(3):
        corner = 3 * face + i
        a, b = ids[following(corner)], ids[preceding(corner)]
        squared = (points[a, 0] - points[b, 0]) ** 2 + (points[a, 1] - points[b, 1]) ** 2 + (points[a, 2] - points[b, 2]) ** 2
        x, y, z = 0.5 * (points[a, 0] + points[b, 0]), 0.5 * (points[a, 1] + points[b, 1]), 0.5 * (points[a, 2] + points[b, 2])
        x, y, z = place(quadrics, a, b, origin, x, y, z, HOLD)
        change = math.sqrt(error(quadrics, a, b, origin, x, y, z)) + EVEN * squared
        least = min(least, change)
        cost = change * math.sqrt(squared) if by_curvature else change
        at = i
        while at > 0 and costs[at - 1] > cost:
            costs[at], sides[at] = costs[at - 1], sides[at - 1]
            at -= 1
        costs[at], sides[at] = cost, corner
    if not by_curvature:
        return least
    angle = 0.0
    for i in range(3):
        other = opposite[3 * face + i] // 3
        cosine = 0.0
        for axis in range(3):
            cosine += normals[face, axis] * normals[other, axis]
        angle += math.acos(min(max(cosine, -1.0), 1.0))
    return (angle / 3.0 + LEVEL) * least
