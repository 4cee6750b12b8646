"""The planar example of thesis Fig. 29, made again from its description: a plate with a hole, filled with a lattice."""

from __future__ import annotations

import numpy as np
from scipy.spatial import Delaunay

from core.mesh import Mesh

SIZE_MM = 100.0
HOLE_MM = (35.0, 60.0)  # its centre
HOLE_RADIUS_MM = 15.0


def plate(spacing_mm: float = 4.0, offset: float = 2.236e-3) -> Mesh:
    """Nodes of equilateral triangles, those outside left out, boundary nodes first, Delaunay: thesis 3.4.1, step by step.

    The lowest row of the lattice lies `offset` spacings above the lower side, so the flattest triangles have q = 8 offset²:
    4e-5 as in the thesis. Faces look to +z.
    """
    boundary = _boundary(spacing_mm)
    points = np.concatenate((boundary, _lattice(spacing_mm, offset)))
    triangles = Delaunay(points).simplices
    middles = points[triangles].mean(axis=1)
    a, b, c = (points[triangles[:, corner]] for corner in range(3))
    doubled_areas = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    triangles[doubled_areas < 0] = triangles[doubled_areas < 0][:, ::-1]
    # faces between neighbours on the hole's polygon are inside its circle by less than the polygon's sagitta
    solid = (_from_hole(middles) > 0.99 * HOLE_RADIUS_MM) & (np.abs(doubled_areas) > 1e-9)
    return Mesh.of(np.column_stack((points, np.zeros(len(points)))), triangles[solid])


def _boundary(spacing_mm: float) -> np.ndarray:
    along = np.linspace(0.0, SIZE_MM, int(SIZE_MM / spacing_mm) + 1)[:-1]
    zero, full = np.zeros_like(along), np.full_like(along, SIZE_MM)
    turn = np.linspace(0.0, 2.0 * np.pi, int(2.0 * np.pi * HOLE_RADIUS_MM / spacing_mm) + 1)[:-1]
    hole = np.array(HOLE_MM) + HOLE_RADIUS_MM * np.column_stack((np.cos(turn), np.sin(turn)))
    sides = ((along, zero), (full, along), (SIZE_MM - along, full), (zero, SIZE_MM - along))
    return np.concatenate((*(np.column_stack(side) for side in sides), hole))


def _lattice(spacing_mm: float, offset: float) -> np.ndarray:
    rows = np.arange(offset * spacing_mm, SIZE_MM, spacing_mm * np.sqrt(3.0) / 2.0)
    nodes = np.concatenate(
        [
            np.column_stack((x, np.full_like(x, y)))
            for number, y in enumerate(rows)
            for x in (np.arange((1 - number % 2) * spacing_mm / 2.0, SIZE_MM, spacing_mm),)
        ]
    )
    inside = (nodes > 1e-6).all(axis=1) & (_from_hole(nodes) > HOLE_RADIUS_MM)
    return nodes[inside]


def _from_hole(points: np.ndarray) -> np.ndarray:
    distance: np.ndarray = np.linalg.norm(points - HOLE_MM, axis=1)
    return distance
