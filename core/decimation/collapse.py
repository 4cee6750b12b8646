"""Collapse one edge, if the surface that comes of it is as sound as the one before."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.decimation.box_tree import widen
from core.decimation.kernel import kernel
from core.decimation.nearness import Nearness, stays_near
from core.decimation.placement import place
from core.decimation.room import Obstacles, RoomScratch, has_room
from core.decimation.star import following, gather_star, preceding
from core.decimation.state import GONE, State
from core.decimation.triangle import triangle

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]

HOLD = 1e-5  # pull towards the middle of the edge, against the planes of the faces
MOST_VALENCE = 10  # a vertex that takes another in has at most as many faces, unless one of the two had more before
LEAST_VALENCE = 4  # a vertex that loses a face keeps at least three
TURN_COSINE = 0.5  # a face turns by less than 60 degrees
LONGEST_WAY = 1.0  # of the edge's length: a vertex placed further from its middle goes to the middle

# why an edge was not collapsed; the numbers are rows of the counts that go into the report
DONE, FIXED, REGION, LINK, TURNED, SLIVER, CROWDED, FAR = range(8)
REASONS = ("done", "fixed", "region", "topology", "turned", "sliver", "crowded", "deviation")


class Guards(NamedTuple):
    """least_quality: a new face is at least this good, or as good as the worst it replaces. own_mm: see `has_room`."""

    least_quality: float
    own_mm: float
    thorough: bool


class Scratch(NamedTuple):
    """Arrays for one star; the stamps are per vertex and per face of the whole surface. token: (1,) counts up."""

    star_a: Ints
    star_b: Ints
    rim: Int32s
    normals: Floats
    shape: Floats
    changed: Ints
    vertex_stamp: Ints
    face_stamp: Ints
    token: Ints
    room: RoomScratch

    @classmethod
    def of(cls, state: State) -> Scratch:
        """For a state; twice the most faces that any vertex has now."""
        most = int(np.bincount(state.ids[state.ids != GONE]).max()) + 2 * MOST_VALENCE
        return cls(
            np.empty(most, np.int64), np.empty(most, np.int64), np.empty((2 * most, 2), np.int32),
            np.empty((2 * most, 3)), np.empty(2 * most), np.empty(2 * most, np.int64),
            np.full(len(state.points), -1, np.int64), np.full(len(state.normals), -1, np.int64), np.zeros(1, np.int64),
            RoomScratch.new(),
        )  # fmt: skip


@kernel
def collapse(state: State, side: int, guards: Guards, obstacles: Obstacles, nearness: Nearness, scratch: Scratch) -> int:
    """Collapse the side opposite corner `side`. Returns DONE or why not.

    The vertex that remains is the one that follows the corner; it takes over quadric and members of the other.
    Source: link condition after Dey et al. 1999.
    """
    ids, opposite, points = state.ids, state.opposite, state.points
    other_tip = np.int64(opposite[side])
    a, b = ids[following(side)], ids[preceding(side)]
    if state.fixed[a] and state.fixed[b]:
        return FIXED
    first, second = side // 3, other_tip // 3
    if not _region_allows(state.label, state.room, first, second):
        return REGION
    count_a = gather_star(opposite, following(side), scratch.star_a)
    count_b = gather_star(opposite, preceding(side), scratch.star_b)
    if not _link_holds(ids, opposite, side, count_a, count_b, scratch):
        return LINK

    # the place
    x, y, z = 0.5 * (points[a, 0] + points[b, 0]), 0.5 * (points[a, 1] + points[b, 1]), 0.5 * (points[a, 2] + points[b, 2])
    if state.fixed[a] or state.fixed[b]:
        kept = a if state.fixed[a] else b
        x, y, z = points[kept, 0], points[kept, 1], points[kept, 2]
    else:
        u, v, w = place(state.quadrics, a, b, state.origin, x, y, z, HOLD)
        length = (points[a, 0] - points[b, 0]) ** 2 + (points[a, 1] - points[b, 1]) ** 2 + (points[a, 2] - points[b, 2]) ** 2
        if (u - x) ** 2 + (v - y) ** 2 + (w - z) ** 2 <= LONGEST_WAY**2 * length:
            x, y, z = u, v, w
        x, y, z = float(np.float32(x)), float(np.float32(y)), float(np.float32(z))

    # the faces that change
    scratch.token[0] += 1
    token = scratch.token[0]
    scratch.face_stamp[first], scratch.face_stamp[second] = token, token
    worst = min(state.shape[first], state.shape[second])
    count = 0
    for turn in range(2):
        star, size = (scratch.star_a, count_a) if turn == 0 else (scratch.star_b, count_b)
        for i in range(size):
            corner = star[i]
            face = corner // 3
            scratch.face_stamp[face] = token
            if face in (first, second):
                continue
            worst = min(worst, state.shape[face])
            scratch.changed[count] = face
            scratch.rim[count, 0], scratch.rim[count, 1] = ids[following(corner)], ids[preceding(corner)]
            count += 1
    least = min(worst, guards.least_quality)
    for i in range(count):
        p, q, face = scratch.rim[i, 0], scratch.rim[i, 1], scratch.changed[i]
        nx, ny, nz, _area, shape = triangle(
            x, y, z, points[p, 0], points[p, 1], points[p, 2], points[q, 0], points[q, 1], points[q, 2]
        )
        if nx * state.normals[face, 0] + ny * state.normals[face, 1] + nz * state.normals[face, 2] < TURN_COSINE:
            return TURNED
        if shape < least:
            return SLIVER
        scratch.normals[i, 0], scratch.normals[i, 1], scratch.normals[i, 2], scratch.shape[i] = nx, ny, nz, shape

    # room: vertex a stands in for the new one
    old_x, old_y, old_z = points[a, 0], points[a, 1], points[a, 2]
    points[a, 0], points[a, 1], points[a, 2] = x, y, z
    reason = DONE
    if not has_room(
        points, ids, state.normals, state.boxes, obstacles,
        guards.own_mm, guards.thorough, token, scratch.face_stamp,
        a, count, scratch.rim, scratch.normals, scratch.room,
    ):  # fmt: skip
        reason = CROWDED
    elif nearness.asked and not stays_near(points, state.next_member, a, b, count, scratch.rim, nearness):
        reason = FAR
    if reason != DONE:
        points[a, 0], points[a, 1], points[a, 2] = old_x, old_y, old_z
        return reason

    _join(state, side, count_b, scratch)
    for i in range(count):
        face = scratch.changed[i]
        for axis in range(3):
            state.normals[face, axis] = scratch.normals[i, axis]
        state.shape[face] = scratch.shape[i]
        widen(points, ids, state.boxes, face)
    for i in range(state.quadrics.shape[1]):
        state.quadrics[a, i] += state.quadrics[b, i]
    state.fixed[a] |= state.fixed[b]
    if nearness.asked:
        nearness.limits_mm[a] = min(nearness.limits_mm[a], nearness.limits_mm[b])
    state.room[state.label[first]] -= 1
    state.room[state.label[second]] -= 1
    return DONE


@kernel
def _region_allows(label: Int32s, room: Ints, first: int, second: int) -> bool:
    """May both faces go?"""
    if label[first] == label[second]:
        enough: bool = room[label[first]] >= 2
        return enough
    both: bool = room[label[first]] >= 1 and room[label[second]] >= 1
    return both


@kernel
def _link_holds(ids: Int32s, opposite: Int32s, side: int, count_a: int, count_b: int, scratch: Scratch) -> bool:
    """True if the ends have only the two tips as common neighbours, and the tips can spare a face."""
    if count_a < 0 or count_b < 0:
        return False
    after = count_a + count_b - 4
    if after < LEAST_VALENCE - 1 or (after > MOST_VALENCE and after > max(count_a, count_b)):
        return False
    stamp = scratch.vertex_stamp
    scratch.token[0] += 1
    token = scratch.token[0]
    for i in range(count_a):
        stamp[ids[following(scratch.star_a[i])]] = token
    shared = 0
    for i in range(count_b):
        shared += stamp[ids[following(scratch.star_b[i])]] == token
    if shared != 2:
        return False
    for tip in (side, np.int64(opposite[side])):
        at = tip
        for _ in range(LEAST_VALENCE - 1):
            at = following(opposite[following(at)])
            if at == tip:
                return False
    return True


@kernel
def _join(state: State, side: int, count_b: int, scratch: Scratch) -> None:
    """Take the two faces at the side out, and give the corners of the second end to the first."""
    ids, opposite, corner_of = state.ids, state.opposite, state.corner_of
    a, b = ids[following(side)], ids[preceding(side)]
    other_tip = np.int64(opposite[side])
    for i in range(count_b):
        ids[scratch.star_b[i]] = a
    for tip in (side, other_tip):
        left, right = opposite[following(tip)], opposite[preceding(tip)]
        opposite[left], opposite[right] = right, left
        # `right` lies across the side that leads from the tip to an end of the edge, and its own face runs it back
        corner_of[a], corner_of[ids[tip]] = following(right), preceding(right)
    for face in (side // 3, other_tip // 3):
        for i in range(3):
            ids[3 * face + i] = GONE
    corner_of[b] = GONE
    state.merged_into[b] = a
    state.next_member[state.last_member[a]] = b
    state.last_member[a] = state.last_member[b]
