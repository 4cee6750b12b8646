"""A mesh that can be checked by hand: a tetrahedron of 100 mm, outward faces."""

from __future__ import annotations

import numpy as np

from core.mesh import Mesh

CORNERS_MM = [[0.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]]
TRIANGLES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
TETRAHEDRON = Mesh.of(CORNERS_MM, TRIANGLES)


def scaled(factor: float) -> Mesh:
    """The tetrahedron `factor` times as large."""
    return TETRAHEDRON.with_vertices(TETRAHEDRON.vertices * factor)


def jagged() -> Mesh:
    """A tetrahedron whose coordinates have all the bits of a double and both zeros."""
    corners = np.array(CORNERS_MM) + np.random.default_rng(7).normal(size=(4, 3))
    corners[0] = [0.0, -0.0, 1.0 / 3.0]
    return Mesh.of(corners, TRIANGLES)
