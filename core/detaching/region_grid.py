"""The body inside a box as cubes on a grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from core.mesh import Faces, Mesh, Vertices

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

CELLS = 300_000  # in a box; more make the cut finer than the faces it ends in
FINEST_SHARE = 0.1  # of the edges in the region: finer cubes show nothing more
OFF_CENTRE = (0.4142135e-5, 0.7320508e-5)  # of a cube: rays run beside the round numbers that vertices are made of


@dataclass(frozen=True, eq=False, slots=True)
class RegionGrid:
    """Cubes of size_mm; solid: (X, Y, Z) True where the middle of the cube is inside the surface. low_mm, high_mm: (3,)
    corners of the box, up to which the last cubes may not reach."""

    low_mm: Floats
    high_mm: Floats
    size_mm: float
    solid: Flags

    def middles(self, cubes: Ints) -> Floats:
        """Places (N, 3) mm of cubes (N, 3)."""
        places: Floats = self.low_mm + (cubes + 0.5) * self.size_mm
        return places

    def depth_mm(self) -> Floats:
        """Distance of each cube to the nearest one outside of the body, (X, Y, Z) mm; what is beyond the box counts as body."""
        if self.solid.all():
            return np.full(self.solid.shape, np.inf)
        depth: Floats = distance_transform_edt(self.solid) * self.size_mm
        return depth


def cube_size_mm(low: Floats, high: Floats, edge_mm: float) -> float:
    """So that a box has at most CELLS cubes, and none much smaller than the edges of the surface."""
    return max(float(np.cbrt(np.prod(high - low) / CELLS)), FINEST_SHARE * edge_mm)


def fill_grid(mesh: Mesh, low: Floats, high: Floats, size_mm: float) -> RegionGrid:
    """Which cubes of a box lie inside a closed, outward surface: crossings counted along rays in x.

    Faces that no ray through the box meets are passed over at once."""
    shape = tuple(np.maximum(np.ceil((high - low) / size_mm), 1).astype(np.int64).tolist())
    corners = mesh.triangles()
    above, below = corners.max(axis=1), corners.min(axis=1)
    met = ((above[:, 1:] >= low[1:]) & (below[:, 1:] <= high[1:])).all(axis=1) & (below[:, 0] <= high[0])
    steps = np.zeros((shape[0] + 1, shape[1], shape[2]), dtype=np.int16)
    _count_crossings(np.array(mesh.vertices), np.array(mesh.faces[met]), np.array(low), size_mm, OFF_CENTRE, steps)
    return RegionGrid(np.array(low), np.array(high), size_mm, np.cumsum(steps, axis=0)[:-1] > 0)


@njit(cache=True, nogil=True)
def _count_crossings(
    vertices: Vertices, faces: Faces, low: Floats, size: float, off: tuple[float, float], steps: NDArray[np.int16]
) -> None:
    """steps (X + 1, Y, Z): added to the first cube beyond each place where a ray enters (1) or leaves (-1) the surface."""
    across, rows, columns = steps.shape
    for face in range(len(faces)):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        y_low = min(vertices[a, 1], vertices[b, 1], vertices[c, 1])
        y_high = max(vertices[a, 1], vertices[b, 1], vertices[c, 1])
        z_low = min(vertices[a, 2], vertices[b, 2], vertices[c, 2])
        z_high = max(vertices[a, 2], vertices[b, 2], vertices[c, 2])
        first_row = max(int((y_low - low[1]) / size) - 1, 0)
        last_row = min(int((y_high - low[1]) / size) + 1, rows - 1)
        first_column = max(int((z_low - low[2]) / size) - 1, 0)
        last_column = min(int((z_high - low[2]) / size) + 1, columns - 1)
        for row in range(first_row, last_row + 1):
            y = low[1] + (row + 0.5 + off[0]) * size
            for column in range(first_column, last_column + 1):
                z = low[2] + (column + 0.5 + off[1]) * size
                on_ab, on_bc = _side(vertices, a, b, y, z), _side(vertices, b, c, y, z)
                on_ca = _side(vertices, c, a, y, z)
                if (on_ab > 0.0) != (on_bc > 0.0) or (on_bc > 0.0) != (on_ca > 0.0):
                    continue
                total = on_ab + on_bc + on_ca
                if total == 0.0:
                    continue
                x = (on_bc * vertices[a, 0] + on_ca * vertices[b, 0] + on_ab * vertices[c, 0]) / total
                cube = min(max(int(np.ceil((x - low[0]) / size - 0.5)), 0), across - 1)
                # seen along x, a face that looks back (-x) runs clockwise in y and z: the ray enters there
                steps[cube, row, column] += -1 if total > 0.0 else 1


@njit(cache=True, nogil=True)
def _side(vertices: Vertices, start: int, end: int, y: float, z: float) -> float:
    """Twice the area of the triangle start, end, (y, z); the same number for both faces at an edge, but for the sign."""
    low, high = min(start, end), max(start, end)
    area: float = (vertices[low, 1] - y) * (vertices[high, 2] - z) - (vertices[low, 2] - z) * (vertices[high, 1] - y)
    return area if start < end else -area
