"""Distances between points, segments and triangles: the kernels under `core.geometry.distance`.

Triangles are rows of `corners` (F, 3, 3) float64 mm. Every candidate is the distance between two points that lie on the
triangles, so a result can only err upwards, by rounding; triangles without area are handled as the segments they are.
Source: Ericson, Real-Time Collision Detection (2005), ch. 5.1; candidates after Lin & Manocha.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SLIVER = 1e-12  # squared sine of the angle below which a normal is not trusted alone


@njit(cache=True, nogil=True)
def closest_on_triangle(px: float, py: float, pz: float, corners: Floats, face: int) -> tuple[float, float, float, float]:
    """Closest point of one triangle to (px, py, pz): (squared distance, x, y, z)."""
    ax, ay, az = corners[face, 0, 0], corners[face, 0, 1], corners[face, 0, 2]
    ux, uy, uz = corners[face, 1, 0] - ax, corners[face, 1, 1] - ay, corners[face, 1, 2] - az
    vx, vy, vz = corners[face, 2, 0] - ax, corners[face, 2, 1] - ay, corners[face, 2, 2] - az
    wx, wy, wz = px - ax, py - ay, pz - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    nn = nx * nx + ny * ny + nz * nz
    best, x, y, z = 1e300, ax, ay, az
    if nn > 0.0:
        # barycentric weights of the foot of the perpendicular, times nn
        of_b = (wy * vz - wz * vy) * nx + (wz * vx - wx * vz) * ny + (wx * vy - wy * vx) * nz
        of_c = (uy * wz - uz * wy) * nx + (uz * wx - ux * wz) * ny + (ux * wy - uy * wx) * nz
        if of_b >= 0.0 and of_c >= 0.0 and of_b + of_c <= nn:
            s, t = of_b / nn, of_c / nn
            x, y, z = ax + s * ux + t * vx, ay + s * uy + t * vy, az + s * uz + t * vz
            best = (px - x) ** 2 + (py - y) ** 2 + (pz - z) ** 2
            uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
            if nn > SLIVER * uu * vv:
                return best, x, y, z
    for side in range(3):
        following = (side + 1) % 3
        ox, oy, oz = corners[face, side, 0], corners[face, side, 1], corners[face, side, 2]
        dx, dy, dz = corners[face, following, 0] - ox, corners[face, following, 1] - oy, corners[face, following, 2] - oz
        along = (px - ox) * dx + (py - oy) * dy + (pz - oz) * dz
        dd = dx * dx + dy * dy + dz * dz
        share = 0.0
        if along > 0.0:
            share = 1.0 if along >= dd else along / dd
        qx, qy, qz = ox + share * dx, oy + share * dy, oz + share * dz
        distance = (px - qx) ** 2 + (py - qy) ** 2 + (pz - qz) ** 2
        if distance < best:
            best, x, y, z = distance, qx, qy, qz
    return best, x, y, z


@njit(cache=True, nogil=True)
def between_sides(
    corners_a: Floats, face_a: int, side_a: int, corners_b: Floats, face_b: int, side_b: int
) -> tuple[float, float, float, float]:
    """Common perpendicular of two sides: (squared distance, midpoint x, y, z), or 1e300 if it misses their insides.

    The ends are left to `closest_on_triangle`, which is also what parallel sides need.
    """
    next_a, next_b = (side_a + 1) % 3, (side_b + 1) % 3
    ax, ay, az = corners_a[face_a, side_a, 0], corners_a[face_a, side_a, 1], corners_a[face_a, side_a, 2]
    bx, by, bz = corners_b[face_b, side_b, 0], corners_b[face_b, side_b, 1], corners_b[face_b, side_b, 2]
    ux, uy, uz = corners_a[face_a, next_a, 0] - ax, corners_a[face_a, next_a, 1] - ay, corners_a[face_a, next_a, 2] - az
    vx, vy, vz = corners_b[face_b, next_b, 0] - bx, corners_b[face_b, next_b, 1] - by, corners_b[face_b, next_b, 2] - bz
    rx, ry, rz = ax - bx, ay - by, az - bz
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    ur, vr = ux * rx + uy * ry + uz * rz, vx * rx + vy * ry + vz * rz
    determinant = uu * vv - uv * uv
    of_a, of_b = uv * vr - vv * ur, uu * vr - uv * ur
    if of_a <= 0.0 or of_b <= 0.0 or of_a >= determinant or of_b >= determinant:
        return 1e300, 0.0, 0.0, 0.0
    s, t = of_a / determinant, of_b / determinant
    ax, ay, az = ax + s * ux, ay + s * uy, az + s * uz
    bx, by, bz = bx + t * vx, by + t * vy, bz + t * vz
    distance = (ax - bx) ** 2 + (ay - by) ** 2 + (az - bz) ** 2
    return distance, 0.5 * (ax + bx), 0.5 * (ay + by), 0.5 * (az + bz)


@njit(cache=True, nogil=True)
def sides_of_plane(corners: Floats, face: int, other_corners: Floats, other: int, out: Floats) -> bool:
    """Signed distances of the corners of `other` from the plane of `face` into out (3,); False if it has no plane."""
    ax, ay, az = corners[face, 0, 0], corners[face, 0, 1], corners[face, 0, 2]
    ux, uy, uz = corners[face, 1, 0] - ax, corners[face, 1, 1] - ay, corners[face, 1, 2] - az
    vx, vy, vz = corners[face, 2, 0] - ax, corners[face, 2, 1] - ay, corners[face, 2, 2] - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    nn = nx * nx + ny * ny + nz * nz
    if nn <= SLIVER * (ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz):
        return False
    scale = 1.0 / math.sqrt(nn)
    for corner in range(3):
        wx, wy, wz = (
            other_corners[other, corner, 0] - ax,
            other_corners[other, corner, 1] - ay,
            other_corners[other, corner, 2] - az,
        )
        out[corner] = (wx * nx + wy * ny + wz * nz) * scale
    return True


@njit(cache=True, nogil=True)
def pierce(corners: Floats, face: int, other_corners: Floats, other: int, heights: Floats, best: float, point: Floats) -> float:
    """0 if a side of `other` runs through `face`, else `best`; the place goes to point (3,).

    heights (3,): what `sides_of_plane` found for the corners of `other`.
    """
    for side in range(3):
        following = (side + 1) % 3
        if (heights[side] > 0.0) == (heights[following] > 0.0):
            continue
        share = heights[side] / (heights[side] - heights[following])
        x = other_corners[other, side, 0] + share * (other_corners[other, following, 0] - other_corners[other, side, 0])
        y = other_corners[other, side, 1] + share * (other_corners[other, following, 1] - other_corners[other, side, 1])
        z = other_corners[other, side, 2] + share * (other_corners[other, following, 2] - other_corners[other, side, 2])
        distance, qx, qy, qz = closest_on_triangle(x, y, z, corners, face)
        # the foot is the crossing itself, up to rounding, exactly if the crossing lies in the triangle
        if distance <= 1e-26 * (1.0 + x * x + y * y + z * z):
            point[0], point[1], point[2] = qx, qy, qz
            return 0.0
    return best


@njit(cache=True, nogil=True)
def _lowest(heights: Floats) -> float:
    """Of three."""
    lowest: float = min(heights[0], heights[1], heights[2])
    return lowest


@njit(cache=True, nogil=True)
def _highest(heights: Floats) -> float:
    """Of three."""
    highest: float = max(heights[0], heights[1], heights[2])
    return highest


@njit(cache=True, nogil=True)
def _is_beside(corners: Floats, face: int, other_corners: Floats, other: int, heights: Floats, limit: float) -> bool:
    """True if all of `other` lies so far beyond one side of `face`, seen from above, that its squared distance is over limit.

    heights (3,): what `sides_of_plane` found for the corners of `other`.
    """
    ax, ay, az = corners[face, 0, 0], corners[face, 0, 1], corners[face, 0, 2]
    ux, uy, uz = corners[face, 1, 0] - ax, corners[face, 1, 1] - ay, corners[face, 1, 2] - az
    vx, vy, vz = corners[face, 2, 0] - ax, corners[face, 2, 1] - ay, corners[face, 2, 2] - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    height = 0.0
    if _lowest(heights) > 0.0 or _highest(heights) < 0.0:
        height = min(abs(heights[0]), abs(heights[1]), abs(heights[2]))
    missing = (limit - height * height) * (1.0 + 1e-12)
    for side in range(3):
        following = (side + 1) % 3
        px, py, pz = corners[face, side, 0], corners[face, side, 1], corners[face, side, 2]
        ex, ey, ez = corners[face, following, 0] - px, corners[face, following, 1] - py, corners[face, following, 2] - pz
        mx, my, mz = ey * nz - ez * ny, ez * nx - ex * nz, ex * ny - ey * nx
        least = np.inf
        for corner in range(3):
            wx = other_corners[other, corner, 0] - px
            wy = other_corners[other, corner, 1] - py
            wz = other_corners[other, corner, 2] - pz
            least = min(least, wx * mx + wy * my + wz * mz)
        if least > 0.0 and least * least > missing * (mx * mx + my * my + mz * mz):
            return True
    return False


@njit(cache=True, nogil=True)
def nearer(corners_a: Floats, face_a: int, corners_b: Floats, face_b: int, best: float, heights: Floats, point: Floats) -> float:
    """Squared distance of two triangles if below `best`, else `best`; then point (3,) is halfway between them.

    heights (2, 3): scratch.
    """
    reach = math.sqrt(best) * (1.0 + 1e-12)
    has_plane_a = sides_of_plane(corners_a, face_a, corners_b, face_b, heights[0])
    if has_plane_a and (_lowest(heights[0]) > reach or _highest(heights[0]) < -reach):
        return best
    has_plane_b = sides_of_plane(corners_b, face_b, corners_a, face_a, heights[1])
    if has_plane_b and (_lowest(heights[1]) > reach or _highest(heights[1]) < -reach):
        return best
    if has_plane_a and _is_beside(corners_a, face_a, corners_b, face_b, heights[0], best):
        return best
    if has_plane_b and _is_beside(corners_b, face_b, corners_a, face_a, heights[1], best):
        return best
    for corner in range(3):
        px, py, pz = corners_b[face_b, corner, 0], corners_b[face_b, corner, 1], corners_b[face_b, corner, 2]
        distance, x, y, z = closest_on_triangle(px, py, pz, corners_a, face_a)
        if distance < best:
            best = distance
            point[0], point[1], point[2] = 0.5 * (px + x), 0.5 * (py + y), 0.5 * (pz + z)
        px, py, pz = corners_a[face_a, corner, 0], corners_a[face_a, corner, 1], corners_a[face_a, corner, 2]
        distance, x, y, z = closest_on_triangle(px, py, pz, corners_b, face_b)
        if distance < best:
            best = distance
            point[0], point[1], point[2] = 0.5 * (px + x), 0.5 * (py + y), 0.5 * (pz + z)
    for side_a in range(3):
        for side_b in range(3):
            distance, x, y, z = between_sides(corners_a, face_a, side_a, corners_b, face_b, side_b)
            if distance < best:
                best = distance
                point[0], point[1], point[2] = x, y, z
    if best > 0.0 and has_plane_a and _lowest(heights[0]) < 0.0 < _highest(heights[0]):
        best = pierce(corners_a, face_a, corners_b, face_b, heights[0], best, point)
    if best > 0.0 and has_plane_b and _lowest(heights[1]) < 0.0 < _highest(heights[1]):
        best = pierce(corners_b, face_b, corners_a, face_a, heights[1], best, point)
    return best
