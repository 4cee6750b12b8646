"""The mesh most tests here use: a tetrahedron of 100 mm, outward faces."""

from __future__ import annotations

import numpy as np

from core.mesh import Mesh
from tests.solids import tetrahedron

TETRAHEDRON = tetrahedron(100.0)
CORNERS_MM = TETRAHEDRON.vertices.tolist()
TRIANGLES = TETRAHEDRON.faces.tolist()


def jagged() -> Mesh:
    """A tetrahedron whose coordinates have all the bits of a double and both zeros."""
    corners = TETRAHEDRON.vertices + np.random.default_rng(7).normal(size=(4, 3))
    corners[0] = [0.0, -0.0, 1.0 / 3.0]
    return TETRAHEDRON.with_vertices(corners)
