"""Whether two faces meet other than in the corners and the edge they share: exactly, pair by pair."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.exact_predicates import Points, orient2d, orient3d
from core.geometry.intersection_case import classify_intersections, meets_triangle

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

PLANES = ([0, 1], [1, 2], [2, 0])


def do_meet(corners: Floats, places: Ints, pairs: Ints) -> Flags:
    """For pairs (K, 2) of faces with an area: True where they have a point in common besides corners at equal places.

    corners: (F, 3, 3) mm. places: (F, 3), `position_ids` of the corners. Faces over the same three places count as apart:
    they are found without arithmetic. Corners that touch the inside of a face or side count as meeting.
    """
    meet = np.zeros(len(pairs), dtype=np.bool_)
    first, second = pairs.T
    same = places[first][:, :, None] == places[second][:, None, :]
    shared = same.sum(axis=(1, 2))
    for count, test in ((0, _meet_anywhere), (1, _meet_beyond_corner), (2, _meet_beyond_edge)):
        rows = np.flatnonzero(shared == count)
        if len(rows):
            a = _turned(corners[first[rows]], same[rows].any(axis=2))
            b = _turned(corners[second[rows]], same[rows].any(axis=1))
            meet[rows] = test(a, b)
    return meet


def _turned(corners: Floats, shared: Flags) -> Floats:
    """The corners (K, 3, 3) with those that are shared first."""
    order = np.argsort(~shared, axis=1, kind="stable")
    return np.take_along_axis(corners, order[:, :, None], axis=1)


def _meet_anywhere(a: Floats, b: Floats) -> Flags:
    meet: Flags = classify_intersections(a, b) != 0
    return meet


def _meet_beyond_corner(a: Floats, b: Floats) -> Flags:
    """What they share besides their first corner can be followed, away from it, to the opposite side of one of them."""
    return meets_triangle(a[:, 1], a[:, 2], b) | meets_triangle(b[:, 1], b[:, 2], a)


def _meet_beyond_edge(a: Floats, b: Floats) -> Flags:
    """They share the first two corners, in any order: only if they lie in one plane, on the same side of that edge."""
    u, v, p, q = a[:, 0], a[:, 1], a[:, 2], b[:, 2]
    meet = np.zeros(len(a), dtype=np.bool_)
    flat = np.flatnonzero(orient3d(u, v, p, q) == 0)
    for plane in PLANES:
        turns = [_turn(u[flat], v[flat], tip[flat], plane) for tip in (p, q)]
        meet[flat] |= turns[0] * turns[1] > 0
    return meet


def _turn(u: Points, v: Points, tip: Points, plane: list[int]) -> NDArray[np.int8]:
    return orient2d(u[:, plane], v[:, plane], tip[:, plane])
