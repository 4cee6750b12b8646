"""Where a vertex goes: on the surface that its quadric remembers, as near to a wanted place as that allows."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@njit(cache=True, nogil=True)
def place(
    quadric: Floats, other: Floats, origin: Floats, x: float, y: float, z: float, hold: float
) -> tuple[float, float, float]:
    """Minimise the mean squared distance to the planes of two quadrics (11,) plus hold times that to the wanted place.

    With a small hold a vertex slides freely within a plane, along an edge, and not at all at a corner, so surface and volume
    are kept while triangles even out (Garland & Heckbert 1997, with a preferred place instead of a pseudo-inverse).
    """
    scale = 1.0 / (quadric[10] + other[10])
    a = (quadric[0] + other[0]) * scale + hold
    b = (quadric[1] + other[1]) * scale
    c = (quadric[2] + other[2]) * scale
    d = (quadric[3] + other[3]) * scale + hold
    e = (quadric[4] + other[4]) * scale
    f = (quadric[5] + other[5]) * scale + hold
    # solve for the way from the wanted place: well scaled, and exact where nothing is to be done
    x0, y0, z0 = x - origin[0], y - origin[1], z - origin[2]
    u = -((quadric[6] + other[6]) * scale + (a - hold) * x0 + b * y0 + c * z0)
    v = -((quadric[7] + other[7]) * scale + b * x0 + (d - hold) * y0 + e * z0)
    w = -((quadric[8] + other[8]) * scale + c * x0 + e * y0 + (f - hold) * z0)
    m00, m01, m02 = d * f - e * e, c * e - b * f, b * e - c * d
    m11, m12, m22 = a * f - c * c, b * c - a * e, a * d - b * b
    determinant = a * m00 + b * m01 + c * m02
    dx = (m00 * u + m01 * v + m02 * w) / determinant
    dy = (m01 * u + m11 * v + m12 * w) / determinant
    dz = (m02 * u + m12 * v + m22 * w) / determinant
    return x + dx, y + dy, z + dz


@njit(cache=True, nogil=True)
def error(quadric: Floats, other: Floats, origin: Floats, x: float, y: float, z: float) -> float:
    """Squared distances to the planes of two quadrics, times their areas: mm^4."""
    x0, y0, z0 = x - origin[0], y - origin[1], z - origin[2]
    total: float = (
        x0 * ((quadric[0] + other[0]) * x0 + 2.0 * ((quadric[1] + other[1]) * y0 + (quadric[2] + other[2]) * z0))
        + y0 * ((quadric[3] + other[3]) * y0 + 2.0 * (quadric[4] + other[4]) * z0)
        + z0 * z0 * (quadric[5] + other[5])
        + 2.0 * ((quadric[6] + other[6]) * x0 + (quadric[7] + other[7]) * y0 + (quadric[8] + other[8]) * z0)
        + quadric[9]
        + other[9]
    )
    return max(total, 0.0)
