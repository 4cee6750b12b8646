"""Faces around one place, looked at from there: two of them meet besides in that place where their directions do."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.near_pairs import NONE, Faces, Triangles, find_near_pairs

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MANY_FACES = 64  # at one place or one edge; fewer are compared with each other
PADDING = 1e-9  # of a unit: far more than rounding
STRAIGHT = -0.98  # cosine of the widest angle at the place that is still drawn as a line
SAME_ANGLE = 1e-6  # radians; faces around an edge that differ by more are apart ...
NARROWEST = 1e-9  # ... unless their angle at the place is less, as a sine: rounding then turns them by more


def find_pairs_in_fan(faces: Faces, place: int, members: Ints) -> Ints:
    """Pairs (K, 2) of the members (M,), faces with an area and one corner at the place, that may meet besides there; sorted.

    Directions are drawn onto a cube around the place, so however many needles there are, and whatever their lengths, they
    lie side by side. O(M log M) where they do not cross.
    """
    corner = (faces.places[members] == place).argmax(axis=1)
    ends = np.column_stack(((corner + 1) % 3, (corner + 2) % 3))
    beyond = np.take_along_axis(faces.places[members], ends, axis=1)
    directions = np.take_along_axis(faces.corners[members], ends[:, :, None], axis=1)
    directions = directions - faces.corners[members[:1], corner[:1]][:, None]
    _, row, count = np.unique(beyond, return_inverse=True, return_counts=True)
    # faces that also share one of these are around an edge, and looked at from there
    heavy = np.where(count[row.reshape(beyond.shape)] > MANY_FACES, beyond, NONE)
    lines, of = _draw(directions / np.abs(directions).max(axis=2, keepdims=True))
    hub = np.column_stack((heavy, np.full(len(heavy), NONE)))[of]
    drawn = Triangles(lines, members[of], hub, np.ones(len(of), dtype=np.bool_))
    around = [_around_edge(directions, beyond, members, end) for end in np.unique(heavy[heavy != NONE])]
    return np.concatenate([find_near_pairs(drawn, faces), *around])


def _around_edge(directions: Floats, beyond: Ints, members: Ints, end: int) -> Ints:
    """Pairs of faces around the edge from the place to `end` that lie in one half plane, but for rounding."""
    row, side = np.nonzero(beyond == end)
    axis = directions[row[0], side[0]] / np.linalg.norm(directions[row[0], side[0]])
    out = directions[row, 1 - side]
    first = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    first /= np.linalg.norm(first)
    x, y = out @ first, out @ np.cross(axis, first)
    unsure = np.hypot(x, y) < NARROWEST * np.linalg.norm(out, axis=1)
    turn = np.arctan2(y, x)
    order = np.argsort(turn, kind="stable")
    turn, face = turn[order], members[row[order]]
    number = np.arange(len(turn))
    # those that follow within the angle, once around
    until = np.searchsorted(np.concatenate((turn, turn + 2.0 * np.pi)), turn + SAME_ANGLE, side="right")
    reach = np.where(unsure[order], len(turn), until - number) - 1
    reach = np.minimum(reach, len(turn) - 1)
    start = np.repeat(number, reach)
    step = np.arange(len(start)) - np.repeat(np.cumsum(reach) - reach, reach) + 1
    pairs = np.column_stack((face[start], face[(start + step) % len(turn)]))
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _draw(directions: Floats) -> tuple[Floats, Ints]:
    """Lines on the six sides of a cube, as triangles (N, 3, 3), and which of the pairs of directions (M, 2, 3) each is of.

    The sides are drawn side by side, not as a cube: a line ends where its side does.
    """
    lengths = np.linalg.norm(directions, axis=2)
    cosine = np.einsum("mi,mi->m", directions[:, 0], directions[:, 1]) / (lengths[:, 0] * lengths[:, 1])
    wide = np.flatnonzero(cosine < STRAIGHT)
    lines, of = [], []
    for side in range(6):
        axis, sign = side // 2, 1.0 - 2.0 * (side % 2)
        ahead = sign * directions[:, :, axis]
        across = directions[:, :, [(axis + 1) % 3, (axis + 2) % 3]]
        row, points = _clip(ahead, across)
        keep = ~np.isin(row, wide)
        ends = np.concatenate((points[keep], np.full((int(keep.sum()), 2, 1), 3.0 * side)), axis=2)
        lines += [ends[:, [0, 1, 1]], _whole_side(3.0 * side, len(wide))]
        of += [row[keep], np.repeat(wide, 2)]
    return np.concatenate(lines), np.concatenate(of)


def _whole_side(height: float, count: int) -> Floats:
    """Two triangles that cover a side of the cube, `count` times, (2 count, 3, 3)."""
    a, b, c, d = ([x, y, height] for x, y in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)))
    return np.tile(np.array([[a, b, c], [a, c, d]]), (count, 1, 1)).reshape(-1, 3, 3)


def _clip(ahead: Floats, across: Floats) -> tuple[Ints, Floats]:
    """What of the sectors between two directions is seen through a side of the cube: rows (N,), ends (N, 2, 2) in -1 to 1.

    ahead: (M, 2) along the normal of the side, across: (M, 2, 2) along it.
    Source: Liang and Barsky 1984, doi:10.1145/357332.357333.
    """
    begin, end = np.zeros(len(ahead)), np.ones(len(ahead))
    seen = np.ones(len(ahead), dtype=np.bool_)
    for k in range(2):
        for sign in (-1.0, 1.0):
            inside = ahead + sign * across[:, :, k] + PADDING
            seen &= (inside >= 0.0).any(axis=1)
            with np.errstate(divide="ignore", invalid="ignore"):
                crossing = inside[:, 0] / (inside[:, 0] - inside[:, 1])
            begin = np.where(inside[:, 0] < 0.0, np.maximum(begin, crossing), begin)
            end = np.where(inside[:, 1] < 0.0, np.minimum(end, crossing), end)
    rows = np.flatnonzero(seen & (begin <= end))
    share = np.column_stack((begin, end))[rows]
    depth = (1.0 - share) * ahead[rows, :1] + share * ahead[rows, 1:]
    flat = (1.0 - share)[:, :, None] * across[rows, :1] + share[:, :, None] * across[rows, 1:]
    ends: Floats = flat / np.maximum(depth, PADDING)[:, :, None]
    return rows, np.clip(ends, -1.0, 1.0)
