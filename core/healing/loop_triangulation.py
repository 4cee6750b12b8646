"""Triangles over the rim of a hole, without new vertices."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

LONGEST_AT_ONCE = 160  # vertices: time grows with the third power, so longer rims are cut by chords first
TIE = 1e-9  # of 1 - cos: bends that differ by less are alike, and the area decides
FLAT_BEND = 3.0  # for a triangle without area: worse than folding back
FORBIDDEN_BEND = 100.0  # for a chord that is an edge of the surface already
THIN = 1e-20  # squared doubled area against the squared sides' product: no normal to trust


def triangulate_loop(points: Floats, outer: Floats, forbidden: Flags) -> Ints:
    """Cover a closed line with n - 2 triangles, (n - 2, 3) numbers of its points, running as the line does.

    points: (n, 3) mm. outer: (n, 3) tip of the face beyond the side from each point to the next; NaN where there is none.
    forbidden: (n, n) True where two points must not be joined. Of all ways the one that bends least where it bends most,
    also against the faces beyond the sides, and of these the one with the least area.

    Source: Barequet & Sharir 1995, doi:10.1016/0167-8396(94)00011-G; Liepa 2003, doi:10.2312/SGP/SGP03/200-206.
    """
    parts = [np.arange(len(points))]
    triangles = []
    while parts:
        part = parts.pop()
        if len(part) > LONGEST_AT_ONCE:
            chord = np.empty(2, dtype=np.int64)
            if _find_chord(points[part], outer[part], forbidden[np.ix_(part, part)], chord):
                low, high = chord
                parts += [part[low : high + 1], np.concatenate((part[high:], part[: low + 1]))]
                continue
        tips = outer[part].copy()
        beyond = (part + 1) % len(points) != np.roll(part, -1)
        tips[beyond] = np.nan  # a chord: the face beyond it is not there yet
        found = np.empty((len(part) - 2, 3), dtype=np.int64)
        _triangulate(points[part], tips, forbidden[np.ix_(part, part)], found)
        triangles.append(part[found])
    return np.concatenate(triangles)


@njit(cache=True, nogil=True)
def _normal(points: Floats, i: int, j: int, k: int, out: Floats) -> float:
    """Unit normal of a triangle into out (3,), NaN if it has none; returns the area."""
    ux, uy, uz = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]
    vx, vy, vz = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1], points[k, 2] - points[i, 2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    squared = nx * nx + ny * ny + nz * nz
    if squared <= THIN * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
        out[:] = np.nan
        return 0.0
    length = np.sqrt(squared)
    out[0], out[1], out[2] = nx / length, ny / length, nz / length
    area: float = 0.5 * length
    return area


@njit(cache=True, nogil=True)
def _bend(a: Floats, b: Floats) -> float:
    """1 - cos between two unit normals; 0 if either is NaN."""
    bend: float = 1.0 - (a[0] * b[0] + a[1] * b[1] + a[2] * b[2])
    if np.isnan(bend):
        return 0.0
    return bend


@njit(cache=True, nogil=True)
def _triangulate(points: Floats, outer: Floats, forbidden: Flags, found: Ints) -> None:
    """Fill found (n - 2, 3): dynamic programming over all chords."""
    count = len(points)
    bends, areas = np.zeros((count, count)), np.zeros((count, count))
    normals = np.full((count, count, 3), np.nan)  # of the face at each chord, on the side of the later points
    splits = np.zeros((count, count), dtype=np.int64)
    side, corners, normal = np.empty((count, 3)), np.empty((3, 3)), np.empty(3)
    for i in range(count):
        following = (i + 1) % count
        corners[0], corners[1], corners[2] = points[following], points[i], outer[i]
        if np.isnan(outer[i, 0]):
            side[i] = np.nan
        else:
            _normal(corners, 0, 1, 2, side[i])
        if following > i:
            normals[i, following] = side[i]
    for gap in range(2, count):
        for i in range(count - gap):
            k = i + gap
            best_bend, best_area, best = 1e30, 1e30, i + 1
            for m in range(i + 1, k):
                area = _normal(points, i, m, k, normal)
                bend = max(bends[i, m], bends[m, k])
                if area == 0.0:
                    bend = max(bend, FLAT_BEND)
                if forbidden[i, k] and gap < count - 1:
                    bend = max(bend, FORBIDDEN_BEND)
                bend = max(bend, _bend(normal, normals[i, m]), _bend(normal, normals[m, k]))
                if gap == count - 1:
                    bend = max(bend, _bend(normal, side[k]))
                area += areas[i, m] + areas[m, k]
                if bend < best_bend - TIE or (bend <= best_bend + TIE and area < best_area):
                    best_bend, best_area, best = bend, area, m
            bends[i, k], areas[i, k], splits[i, k] = best_bend, best_area, best
            _normal(points, i, best, k, normals[i, k])
    stack = np.empty((count + 2, 2), dtype=np.int64)
    stack[0, 0], stack[0, 1], top, filled = 0, count - 1, 1, 0
    while top > 0:
        top -= 1
        i, k = stack[top]
        if k - i < 2:
            continue
        m = splits[i, k]
        found[filled, 0], found[filled, 1], found[filled, 2] = i, m, k
        filled += 1
        stack[top, 0], stack[top, 1] = i, m
        stack[top + 1, 0], stack[top + 1, 1] = m, k
        top += 2


@njit(cache=True, nogil=True)
def _find_chord(points: Floats, outer: Floats, forbidden: Flags, chord: Ints) -> bool:
    """The chord that is shortest against the way along the line, and leaves both its ends into the hole."""
    count = len(points)
    way, inward = np.zeros(count + 1), np.zeros((count, 3))
    for i in range(count):
        following = (i + 1) % count
        length, away = 0.0, 0.0
        for axis in range(3):
            length += (points[following, axis] - points[i, axis]) ** 2
            away += (0.5 * (points[following, axis] + points[i, axis]) - outer[i, axis]) ** 2
        way[i + 1] = way[i] + np.sqrt(length)
        if away > 0.0:  # False for NaN
            for axis in range(3):
                step = (0.5 * (points[following, axis] + points[i, axis]) - outer[i, axis]) / np.sqrt(away)
                inward[i, axis] += step
                inward[following, axis] += step
    best, shortest = np.inf, count // 8
    for i in range(count):
        for k in range(i + shortest, min(count, i + count - shortest)):
            if forbidden[i, k]:
                continue
            squared, leaves, arrives = 0.0, 0.0, 0.0
            for axis in range(3):
                step = points[k, axis] - points[i, axis]
                squared += step * step
                leaves += step * inward[i, axis]
                arrives -= step * inward[k, axis]
            if squared == 0.0 or leaves < 0.0 or arrives < 0.0:
                continue
            along = way[k] - way[i]
            share = np.sqrt(squared) / min(along, way[count] - along)
            if share < best:
                best = share
                chord[0], chord[1] = i, k
    found: bool = best < np.inf
    return found
