"""Where a vertex goes: on the surface that its quadric remembers, as near to a wanted place as that allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.decimation.kernel import kernel

Floats = NDArray[np.float64]


@kernel
def place(
    quadrics: Floats, a: int, b: int, origin: Floats, x: float, y: float, z: float, hold: float
) -> tuple[float, float, float]:
    """Minimise the mean squared distance to the planes of quadrics (V, 11) a and b plus hold times that to the wanted place.

    With a small hold a vertex slides freely within a plane, along an edge, and not at all at a corner, so surface and volume
    are kept while triangles even out (Garland & Heckbert 1997, with a preferred place instead of a pseudo-inverse).
    """
    scale = 1.0 / (quadrics[a, 10] + quadrics[b, 10])
    xx = (quadrics[a, 0] + quadrics[b, 0]) * scale
    xy = (quadrics[a, 1] + quadrics[b, 1]) * scale
    xz = (quadrics[a, 2] + quadrics[b, 2]) * scale
    yy = (quadrics[a, 3] + quadrics[b, 3]) * scale
    yz = (quadrics[a, 4] + quadrics[b, 4]) * scale
    zz = (quadrics[a, 5] + quadrics[b, 5]) * scale
    # solve for the way from the wanted place: well scaled, and exact where nothing is to be done
    x0, y0, z0 = x - origin[0], y - origin[1], z - origin[2]
    u = -((quadrics[a, 6] + quadrics[b, 6]) * scale + xx * x0 + xy * y0 + xz * z0)
    v = -((quadrics[a, 7] + quadrics[b, 7]) * scale + xy * x0 + yy * y0 + yz * z0)
    w = -((quadrics[a, 8] + quadrics[b, 8]) * scale + xz * x0 + yz * y0 + zz * z0)
    xx, yy, zz = xx + hold, yy + hold, zz + hold
    m00, m01, m02 = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    m11, m12, m22 = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    inverse = 1.0 / (xx * m00 + xy * m01 + xz * m02)
    dx = (m00 * u + m01 * v + m02 * w) * inverse
    dy = (m01 * u + m11 * v + m12 * w) * inverse
    dz = (m02 * u + m12 * v + m22 * w) * inverse
    return x + dx, y + dy, z + dz


@kernel
def error(quadrics: Floats, a: int, b: int, origin: Floats, x: float, y: float, z: float) -> float:
    """Squared distances to the planes of two quadrics, times their areas: mm^4."""
    x0, y0, z0 = x - origin[0], y - origin[1], z - origin[2]
    total: float = (
        x0
        * (
            (quadrics[a, 0] + quadrics[b, 0]) * x0
            + 2.0 * ((quadrics[a, 1] + quadrics[b, 1]) * y0 + (quadrics[a, 2] + quadrics[b, 2]) * z0)
        )
        + y0 * ((quadrics[a, 3] + quadrics[b, 3]) * y0 + 2.0 * (quadrics[a, 4] + quadrics[b, 4]) * z0)
        + z0 * z0 * (quadrics[a, 5] + quadrics[b, 5])
        + 2.0
        * (
            (quadrics[a, 6] + quadrics[b, 6]) * x0
            + (quadrics[a, 7] + quadrics[b, 7]) * y0
            + (quadrics[a, 8] + quadrics[b, 8]) * z0
        )
        + quadrics[a, 9]
        + quadrics[b, 9]
    )
    return max(total, 0.0)
