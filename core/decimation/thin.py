"""Take faces out, the least important first, until as many are left as wanted."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.decimation.collapse import DONE, HOLD, Guards, Scratch, collapse
from core.decimation.face_heap import entry, pop, push, replace_first
from core.decimation.kernel import kernel
from core.decimation.nearness import Nearness
from core.decimation.placement import error, place
from core.decimation.room import Obstacles
from core.decimation.star import following, gather_star, preceding
from core.decimation.state import AREA, GONE, State

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]

SLACK = 1 << 54  # in an entry: a priority half as high again is no reason to wait
ALL = (1 << 63) - 1
PIECE = 512  # faces that are worked on together, neighbours on the space-filling curve
LEAST_PIECES = 8  # a surface of fewer is worked on as a whole
EASY = 0.05  # share of the faces that the first limit lets go
MORE_AGAIN = 1.5  # a step takes at most about that much of what the step before took
MORE_AREA = 0.5  # of a face that is to be left, by quadric; more lowers the largest deviation and raises the mean
LEVEL = 1e-3  # radians; among faces flatter than about this the distance decides alone
EVEN = 1e-6  # of a side, as a distance: among collapses that change nothing, the shortest first


class Queue(NamedTuple):
    """Heaps of faces, one for each piece of the surface, side by side in one array; sizes: entries of each.

    queued: (F,) faces in a heap. bits and number: the same four bytes. costs, sides: (3,) of the face at hand. more_area: mm²
    that every vertex counts for besides its own, see `_priority`.
    """

    heap: Ints
    sizes: Ints
    queued: NDArray[np.bool_]
    bits: Int32s
    number: NDArray[np.float32]
    costs: Floats
    sides: Ints
    more_area: float

    @classmethod
    def of(cls, faces: int, more_area: float) -> Queue:
        """Empty."""
        bits = np.zeros(1, np.int32)
        return cls(
            np.empty(faces, np.int64), np.zeros(-(-faces // PIECE), np.int64), np.zeros(faces, np.bool_),
            bits, bits.view(np.float32), np.empty(3), np.empty(3, np.int64), more_area,
        )  # fmt: skip


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
    On a large surface one piece of it after the other goes up to a limit, which then rises by a half: what is worked on stays
    in the cache, and nothing is out of turn by more than that half. The last step is in order over the whole surface.
    counts: (8,) attempts by outcome, added to.
    """
    total = len(state.ids) // 3
    area = float(state.quadrics[state.corner_of != GONE, AREA].sum())
    queue = Queue.of(total, 0.0 if by_curvature else MORE_AREA * area / goal)
    work = (by_curvature, guards, obstacles, nearness, scratch, counts)
    _fill(state, by_curvature, queue, PIECE)
    if total >= LEAST_PIECES * PIECE:
        listed = _listed(queue, PIECE)
        limit = listed[int(EASY * len(listed))] if len(listed) else 0
        while faces > goal:
            before = faces
            faces = _drain(state, goal, faces, limit, queue, PIECE, *work)
            if faces - MORE_AGAIN * (before - faces) <= goal or not queue.sizes.any():
                break
            limit += SLACK
    listed = _listed(queue, PIECE)
    queue.heap[: len(listed)] = listed  # what is sorted is a heap
    queue.sizes[:] = 0
    queue.sizes[0] = len(listed)
    left: int = _drain(state, goal, faces, ALL, queue, total, *work)
    return left


def _listed(queue: Queue, piece: int) -> Ints:
    """The entries of all heaps in order."""
    starts = piece * np.arange(len(queue.sizes))
    parts = [queue.heap[start : start + size] for start, size in zip(starts.tolist(), queue.sizes.tolist(), strict=True)]
    return np.sort(np.concatenate(parts))


@kernel
def _fill(state: State, by_curvature: bool, queue: Queue, piece: int) -> None:
    """Queue every face, each in the heap of its piece."""
    for face in range(len(state.ids) // 3):
        if state.ids[3 * face] != GONE:
            _queue(state, by_curvature, queue, piece, face)


@kernel
def _queue(state: State, by_curvature: bool, queue: Queue, piece: int, face: int) -> None:
    heap = face // piece
    code = _code(state, by_curvature, queue, face)
    queue.sizes[heap] = push(queue.heap, heap * piece, queue.sizes[heap], code)
    queue.queued[face] = True


@kernel
def _code(state: State, by_curvature: bool, queue: Queue, face: int) -> np.int64:
    """The entry of a face as it is now; the order of its sides is left in queue.sides."""
    priority = _priority(
        state.ids, state.opposite, state.points, state.normals, state.quadrics, state.origin,
        face, by_curvature, queue.costs, queue.sides, queue.more_area,
    )  # fmt: skip
    code: np.int64 = entry(priority, face, queue.bits, queue.number)
    return code


@kernel
def _drain(
    state: State,
    goal: int,
    faces: int,
    limit: int,
    queue: Queue,
    piece: int,
    by_curvature: bool,
    guards: Guards,
    obstacles: Obstacles,
    nearness: Nearness,
    scratch: Scratch,
    counts: Ints,
) -> int:
    """Take from each heap in turn what is not above the limit; returns how many faces are left."""
    ids, opposite = state.ids, state.opposite
    for turn in range((len(queue.queued) + piece - 1) // piece):
        base = turn * piece
        while faces > goal and queue.sizes[turn] > 0:
            first = queue.heap[base]
            if first > limit:
                break
            face = first & 0xFFFFFFFF
            if ids[3 * face] == GONE:
                queue.sizes[turn] = pop(queue.heap, base, queue.sizes[turn])
                continue
            code = _code(state, by_curvature, queue, face)
            if code > first + SLACK:
                replace_first(queue.heap, base, queue.sizes[turn], code)
                continue
            queue.sizes[turn] = pop(queue.heap, base, queue.sizes[turn])
            queue.queued[face] = False
            for i in range(3):
                side = queue.sides[i]
                kept = ids[following(side)]
                outcome = collapse(state, side, guards, obstacles, nearness, scratch)
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
                        if not queue.queued[near]:
                            _queue(state, by_curvature, queue, piece, near)
                break
    return faces


@kernel
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
    more_area: float,
) -> float:
    """Priority of a face; its sides, named by the corners opposite, go to sides (3,) in the order to try. costs: scratch.

    What a collapse changes is the distance to the former planes, root mean square, times the root of the area: mm². The area
    alone would give away a narrow fold, such as the rim of an ear, for a millimetre: so some is added to everybody's.
    By curvature, the change times the mean angle to the neighbours is the priority, and the shorter of two sides goes first.
    """
    least = np.inf
    for i in range(3):
        corner = 3 * face + i
        a, b = ids[following(corner)], ids[preceding(corner)]
        squared = (points[a, 0] - points[b, 0]) ** 2 + (points[a, 1] - points[b, 1]) ** 2 + (points[a, 2] - points[b, 2]) ** 2
        x, y, z = 0.5 * (points[a, 0] + points[b, 0]), 0.5 * (points[a, 1] + points[b, 1]), 0.5 * (points[a, 2] + points[b, 2])
        x, y, z = place(quadrics, a, b, origin, x, y, z, HOLD)
        weight = 1.0 + more_area / (quadrics[a, AREA] + quadrics[b, AREA])
        change = math.sqrt(weight * error(quadrics, a, b, origin, x, y, z)) + EVEN * squared
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
