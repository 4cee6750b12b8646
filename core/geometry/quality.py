"""Triangle quality q (thesis 2.4.1) and edge lengths."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.mesh import Faces, Vertices


def side_lengths(vertices: Vertices, faces: Faces) -> NDArray[np.float64]:
    """Lengths in mm, (F, 3); side i lies opposite corner i."""
    corners = vertices[faces]
    sides = np.roll(corners, -1, axis=1) - np.roll(corners, -2, axis=1)
    lengths: NDArray[np.float64] = np.sqrt(np.einsum("fij,fij->fi", sides, sides))
    return lengths


def quality(vertices: Vertices, faces: Faces) -> NDArray[np.float64]:
    """q = 2 r_in / r_out per face, (F,): 1 for an equilateral triangle, 0 for one without area.

    The thesis writes (b+c-a)(c+a-b)(a+b-c)/(abc). The equal form 16 A² / (abc (a+b+c)) is used: it does not lose the
    digits of a needle, whose longest side nearly equals the sum of the others.
    """
    shape = np.empty(len(faces))
    _fill_quality(np.require(vertices, np.float64, ["C", "W"]), np.require(faces, np.int32, ["C", "W"]), shape)
    return shape


@njit(cache=True, nogil=True)
def _fill_quality(vertices: Vertices, faces: Faces, shape: NDArray[np.float64]) -> None:
    """shape (F,) is filled."""
    for face in range(len(faces)):
        p, q, r = faces[face, 0], faces[face, 1], faces[face, 2]
        ux, uy, uz = vertices[q, 0] - vertices[p, 0], vertices[q, 1] - vertices[p, 1], vertices[q, 2] - vertices[p, 2]
        vx, vy, vz = vertices[r, 0] - vertices[p, 0], vertices[r, 1] - vertices[p, 1], vertices[r, 2] - vertices[p, 2]
        wx, wy, wz = vertices[r, 0] - vertices[q, 0], vertices[r, 1] - vertices[q, 1], vertices[r, 2] - vertices[q, 2]
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        a = math.sqrt(ux * ux + uy * uy + uz * uz)
        b = math.sqrt(vx * vx + vy * vy + vz * vz)
        c = math.sqrt(wx * wx + wy * wy + wz * wz)
        product = a * b * c * (a + b + c)
        # rounding may lift an equilateral triangle one bit above 1
        shape[face] = min(4.0 * (x * x + y * y + z * z) / product, 1.0) if product > 0.0 else 0.0
