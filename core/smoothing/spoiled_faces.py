"""Which faces a step would turn over or spoil, in one pass."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def find_spoiled(before: Vertices, after: Vertices, faces: Faces, asked: Ints, least_quality: Floats) -> Ints:
    """Faces of `asked` (K,) whose normal points against the one before, or whose q falls below their least.

    before, after: (V, 3) mm. faces: (F, 3). least_quality: (F,). q = 2 r_in / r_out as `core.geometry.quality` has it.
    """
    spoiled = np.zeros(len(asked), dtype=np.bool_)
    _mark(before, after, faces, asked, least_quality, spoiled)
    return asked[spoiled]


@njit(cache=True, nogil=True)
def _mark(
    before: Vertices, after: Vertices, faces: Faces, asked: Ints, least_quality: Floats, spoiled: NDArray[np.bool_]
) -> None:
    """spoiled (K,) must hold False."""
    for i in range(len(asked)):
        face = asked[i]
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        mx, my, mz, _product = _cross(before, a, b, c)
        nx, ny, nz, product = _cross(after, a, b, c)
        q = 4.0 * (nx * nx + ny * ny + nz * nz) / product if product > 0.0 else 0.0
        spoiled[i] = mx * nx + my * ny + mz * nz <= 0.0 or q < least_quality[face]


@njit(cache=True, nogil=True)
def _cross(vertices: Vertices, a: int, b: int, c: int) -> tuple[float, float, float, float]:
    """Normal, twice the area long, and the product of the three sides and their sum."""
    ux, uy, uz = (vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2])
    vx, vy, vz = (vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2])
    wx, wy, wz = vx - ux, vy - uy, vz - uz
    p = math.sqrt(ux * ux + uy * uy + uz * uz)
    q = math.sqrt(vx * vx + vy * vy + vz * vz)
    r = math.sqrt(wx * wx + wy * wy + wz * wz)
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx, p * q * r * (p + q + r)
