"""Normal, area and quality of one triangle, for kernels."""

from __future__ import annotations

import math

from core.decimation.kernel import kernel


@kernel
def triangle(
    px: float, py: float, pz: float, qx: float, qy: float, qz: float, rx: float, ry: float, rz: float
) -> tuple[float, float, float, float, float]:
    """Unit normal x, y, z, twice the area and quality q = 2 r_in / r_out; all zero if the triangle has no area."""
    ux, uy, uz = qx - px, qy - py, qz - pz
    vx, vy, vz = rx - px, ry - py, rz - pz
    wx, wy, wz = rx - qx, ry - qy, rz - qz
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    squared = nx * nx + ny * ny + nz * nz
    if squared == 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    a = math.sqrt(ux * ux + uy * uy + uz * uz)
    b = math.sqrt(vx * vx + vy * vy + vz * vz)
    c = math.sqrt(wx * wx + wy * wy + wz * wz)
    doubled_area = math.sqrt(squared)
    return nx / doubled_area, ny / doubled_area, nz / doubled_area, doubled_area, 4.0 * squared / (a * b * c * (a + b + c))
