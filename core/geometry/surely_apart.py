"""A quick no: two faces that, in float64 with bounds of error, meet in nothing but their shared corners and edge.

Source: Shewchuk 1997, doi:10.1007/PL00009321 (the bounds).
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.exact_predicates import BOUND_2D, BOUND_3D, UNDERFLOW

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def surely_apart(corners: Floats, places: Ints, i: int, j: int) -> bool:
    """True only if faces i and j of corners (F, 3, 3) have no point in common but corners at equal places (F, 3).

    False says nothing. A plane, or the line of a side seen along an axis, has to lie strictly between what they do not share.
    """
    for axis in range(3):
        if _lowest(corners, i, axis) > _highest(corners, j, axis) or _lowest(corners, j, axis) > _highest(corners, i, axis):
            return True
    if _beside_plane(corners, places, i, j) or _beside_plane(corners, places, j, i):
        return True
    for side in range(3):
        for axis in range(3):
            if _beside_line(corners, places, i, j, side, axis) or _beside_line(corners, places, j, i, side, axis):
                return True
    return False


@njit(cache=True, nogil=True)
def _lowest(corners: Floats, face: int, axis: int) -> float:
    lowest: float = min(corners[face, 0, axis], corners[face, 1, axis], corners[face, 2, axis])
    return lowest


@njit(cache=True, nogil=True)
def _highest(corners: Floats, face: int, axis: int) -> float:
    highest: float = max(corners[face, 0, axis], corners[face, 1, axis], corners[face, 2, axis])
    return highest


@njit(cache=True, nogil=True)
def _beside_plane(corners: Floats, places: Ints, face: int, other: int) -> bool:
    """True if all corners of `other` that are none of `face`'s lie strictly on one side of its plane."""
    side = 0
    for k in range(3):
        place = places[other, k]
        if place == places[face, 0] or place == places[face, 1] or place == places[face, 2]:
            continue
        sign = _sign_3d(corners, face, other, k)
        if sign == 0 or sign == -side:
            return False
        side = sign
    return side != 0


@njit(cache=True, nogil=True)
def _beside_line(corners: Floats, places: Ints, face: int, other: int, k: int, axis: int) -> bool:
    """True if, seen along the axis, the line of the side opposite corner k has `face` strictly on one side and the corners of
    `other` that are none of that side's strictly on the other."""
    a, b = (k + 1) % 3, (k + 2) % 3
    own = _sign_2d(corners, face, a, b, face, k, axis)
    if own == 0:
        return False
    for corner in range(3):
        place = places[other, corner]
        if place == places[face, a] or place == places[face, b]:
            continue
        if _sign_2d(corners, face, a, b, other, corner, axis) != -own:
            return False
    return True


@njit(cache=True, nogil=True)
def _sign_2d(corners: Floats, face: int, a: int, b: int, other: int, c: int, axis: int) -> int:
    """Orientation of corners a, b of `face` and c of `other` seen along the axis; 0 where float64 cannot tell."""
    x, y = (axis + 1) % 3, (axis + 2) % 3
    left = (corners[face, a, x] - corners[other, c, x]) * (corners[face, b, y] - corners[other, c, y])
    right = (corners[face, a, y] - corners[other, c, y]) * (corners[face, b, x] - corners[other, c, x])
    determinant = left - right
    if abs(determinant) <= BOUND_2D * (abs(left) + abs(right)) + UNDERFLOW:
        return 0
    return 1 if determinant > 0.0 else -1


@njit(cache=True, nogil=True)
def _sign_3d(corners: Floats, face: int, other: int, k: int) -> int:
    """Side of the plane of `face` on which corner k of `other` lies; 0 where float64 cannot tell."""
    dx, dy, dz = corners[other, k, 0], corners[other, k, 1], corners[other, k, 2]
    ux, uy, uz = corners[face, 0, 0] - dx, corners[face, 0, 1] - dy, corners[face, 0, 2] - dz
    vx, vy, vz = corners[face, 1, 0] - dx, corners[face, 1, 1] - dy, corners[face, 1, 2] - dz
    wx, wy, wz = corners[face, 2, 0] - dx, corners[face, 2, 1] - dy, corners[face, 2, 2] - dz
    first, second, third, fourth, fifth, sixth = vx * wy, wx * vy, wx * uy, ux * wy, ux * vy, vx * uy
    determinant = uz * (first - second) + vz * (third - fourth) + wz * (fifth - sixth)
    permanent = (abs(first) + abs(second)) * abs(uz) + (abs(third) + abs(fourth)) * abs(vz) + (abs(fifth) + abs(sixth)) * abs(wz)
    if abs(determinant) <= BOUND_3D * permanent + UNDERFLOW:
        return 0
    return 1 if determinant > 0.0 else -1
