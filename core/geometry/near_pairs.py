"""Which triangles may meet, found by halving space again and again: also among thousands of needles that run into one corner.

Boxes around needles overlap where the needles do not. Cells do not care how long a triangle is, and one in which all
triangles have a corner in common, whose own pairs are somebody else's task, needs no looking into.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.surely_apart import surely_apart

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

NONE = -1
FEW = 12  # triangles that do not share the corner that most do: each is compared with all others of the cell
DEEPEST = 96  # halvings; a cell is then 2^32 times smaller than everything along each axis
NO_GAIN = 9  # halvings, three along each axis, without a quarter fewer triangles: a corner with that many faces
MANY = 256  # triangles; more are halved to the end, since comparing them all would cost more
PADDING = 1e-9  # of the largest extent: far more than rounding


class Triangles(NamedTuple):
    """What lies in space: corners (N, 3, 3), the face each is of (N,), what no pair of them may share (N, 3), NONE for nothing.

    asked: (N,) a pair needs one of these.
    """

    corners: Floats
    face: Ints
    hub: Ints
    asked: Flags


class Faces(NamedTuple):
    """The faces themselves: corners (F, 3, 3), equal corners have equal places (F, 3)."""

    corners: Floats
    places: Ints


def find_near_pairs(triangles: Triangles, faces: Faces) -> Ints:
    """Pairs (K, 2) of faces that share no hub and may meet besides in shared corners: all that do, and few others; sorted.

    O(N log N) for triangles that lie apart from each other, however long, and however many share a hub.
    """
    if not triangles.asked.any():
        return np.empty((0, 2), dtype=np.int64)
    low, high = triangles.corners.min(axis=(0, 1)), triangles.corners.max(axis=(0, 1))
    padding = PADDING * float(np.abs(triangles.corners).max())
    box = np.concatenate((low - padding, high + padding))
    return np.unique(_find(triangles, faces, box, padding), axis=0)


@njit(cache=True, nogil=True)
def _find(triangles: Triangles, faces: Faces, whole: Floats, padding: float) -> Ints:
    """Depth first; the list of a cell lies on top of the pool, those of its halves take its place."""
    count = len(triangles.corners)
    pool, kept, found, pairs = np.arange(count), np.empty(count, np.int64), 0, np.empty((64, 2), np.int64)
    boxes, frames, top = np.empty((DEEPEST + 2, 6)), np.empty((DEEPEST + 2, 5), np.int64), 1
    boxes[0], frames[0] = whole, 0  # start, size, depth, fewest so far, halvings since
    frames[0, 1], frames[0, 3] = count, count
    while top > 0:
        top -= 1
        start, size, depth, fewest, since = frames[top, 0], frames[top, 1], frames[top, 2], frames[top, 3], frames[top, 4]
        members = pool[start : start + size]
        hub, others, asked = _commonest_hub(triangles, members)
        if others == 0 or not asked:
            continue
        fewest, since = (others, 0) if 4 * others <= 3 * fewest else (fewest, since + 1)
        if others <= FEW or depth == DEEPEST or (since >= NO_GAIN and others <= MANY):
            found, pairs = _compare(triangles, faces, members, hub, padding, found, pairs)
            continue
        kept[:size] = members
        if start + 2 * size > len(pool):
            pool = np.concatenate((pool, np.empty(len(pool) + size, np.int64)))
        box, axis = boxes[top].copy(), 0
        for other in range(1, 3):
            if box[other + 3] - box[other] > box[axis + 3] - box[axis]:
                axis = other
        middle = 0.5 * (box[axis] + box[axis + 3])
        for half in range(2):
            boxes[top] = box
            boxes[top, axis + 3 * (1 - half)] = middle
            inside = 0
            for i in range(size):
                if _meets_box(triangles.corners, kept[i], boxes[top], padding):
                    pool[start + inside] = kept[i]
                    inside += 1
            if inside > 0:
                frames[top, 0], frames[top, 1], frames[top, 2] = start, inside, depth + 1
                frames[top, 3], frames[top, 4] = fewest, since
                start += inside
                top += 1
    return pairs[:found]


@njit(cache=True, nogil=True)
def _commonest_hub(triangles: Triangles, members: Ints) -> tuple[int, int, bool]:
    """A hub that many of them share, how many do not, and whether any is asked; hubs of three of them stand for election."""
    best, most, asked = NONE, 0, False
    for candidate in (members[0], members[len(members) // 2], members[-1]):
        for k in range(3):
            hub = triangles.hub[candidate, k]
            if hub in (NONE, best):
                continue
            sharing = 0
            for i in members:
                sharing += triangles.hub[i, 0] == hub or triangles.hub[i, 1] == hub or triangles.hub[i, 2] == hub
            if sharing > most:
                best, most = hub, sharing
    for i in members:
        if triangles.asked[i]:
            asked = True
            break
    return best, len(members) - most, asked


@njit(cache=True, nogil=True)
def _shares_hub(hub: Ints, i: int, j: int) -> bool:
    for k in range(3):
        if hub[i, k] != NONE and (hub[i, k] == hub[j, 0] or hub[i, k] == hub[j, 1] or hub[i, k] == hub[j, 2]):
            return True
    return False


@njit(cache=True, nogil=True)
def _compare(
    triangles: Triangles, faces: Faces, members: Ints, common: int, padding: float, found: int, pairs: Ints
) -> tuple[int, Ints]:
    """Add the pairs that may meet, of triangles that do not all have the common hub."""
    hub, corners = triangles.hub, triangles.corners
    for i in members:
        if common != NONE and (hub[i, 0] == common or hub[i, 1] == common or hub[i, 2] == common):
            continue
        for j in members:
            shared = common != NONE and (hub[j, 0] == common or hub[j, 1] == common or hub[j, 2] == common)
            if (not shared and j <= i) or not (triangles.asked[i] or triangles.asked[j]):
                continue
            a, b = min(triangles.face[i], triangles.face[j]), max(triangles.face[i], triangles.face[j])
            if a == b or _boxes_apart(corners, i, j, padding) or _shares_hub(hub, i, j):
                continue
            if surely_apart(faces.corners, faces.places, a, b):
                continue
            if found == len(pairs):
                pairs = np.concatenate((pairs, np.empty_like(pairs)))
            pairs[found, 0], pairs[found, 1] = a, b
            found += 1
    return found, pairs


@njit(cache=True, nogil=True)
def _boxes_apart(corners: Floats, i: int, j: int, padding: float) -> bool:
    for axis in range(3):
        a, b, c = corners[i, 0, axis], corners[i, 1, axis], corners[i, 2, axis]
        p, q, r = corners[j, 0, axis], corners[j, 1, axis], corners[j, 2, axis]
        if min(a, b, c) > max(p, q, r) + padding or max(a, b, c) + padding < min(p, q, r):
            return True
    return False


@njit(cache=True, nogil=True)
def _meets_box(corners: Floats, i: int, box: Floats, padding: float) -> bool:
    """False only if the triangle misses the box (6,).

    Source: separating axes, Akenine-Möller 2001, doi:10.1080/10867651.2001.10487535.
    """
    cx, cy, cz = 0.5 * (box[0] + box[3]), 0.5 * (box[1] + box[4]), 0.5 * (box[2] + box[5])
    hx, hy, hz = 0.5 * (box[3] - box[0]) + padding, 0.5 * (box[4] - box[1]) + padding, 0.5 * (box[5] - box[2]) + padding
    ax, ay, az = corners[i, 0, 0] - cx, corners[i, 0, 1] - cy, corners[i, 0, 2] - cz
    bx, by, bz = corners[i, 1, 0] - cx, corners[i, 1, 1] - cy, corners[i, 1, 2] - cz
    dx, dy, dz = corners[i, 2, 0] - cx, corners[i, 2, 1] - cy, corners[i, 2, 2] - cz
    if min(ax, bx, dx) > hx or max(ax, bx, dx) < -hx or min(ay, by, dy) > hy or max(ay, by, dy) < -hy:
        return False
    if min(az, bz, dz) > hz or max(az, bz, dz) < -hz:
        return False
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, dx - ax, dy - ay, dz - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    # of a needle the normal is all rounding: any axis may separate, but only if all three corners are asked
    p, q, r = nx * ax + ny * ay + nz * az, nx * bx + ny * by + nz * bz, nx * dx + ny * dy + nz * dz
    reach = abs(nx) * hx + abs(ny) * hy + abs(nz) * hz
    if min(p, q, r) > reach or max(p, q, r) < -reach:
        return False
    for ex, ey, ez in ((ux, uy, uz), (vx, vy, vz), (dx - bx, dy - by, dz - bz)):
        p, q, r = ez * ay - ey * az, ez * by - ey * bz, ez * dy - ey * dz
        reach = abs(ez) * hy + abs(ey) * hz
        if min(p, q, r) > reach or max(p, q, r) < -reach:
            return False
        p, q, r = ex * az - ez * ax, ex * bz - ez * bx, ex * dz - ez * dx
        reach = abs(ex) * hz + abs(ez) * hx
        if min(p, q, r) > reach or max(p, q, r) < -reach:
            return False
        p, q, r = ey * ax - ex * ay, ey * bx - ex * by, ey * dx - ex * dy
        reach = abs(ey) * hx + abs(ex) * hy
        if min(p, q, r) > reach or max(p, q, r) < -reach:
            return False
    return True
