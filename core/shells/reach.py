"""How deep a surface lets one go: the inner medial ball at each vertex."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.mesh import Vertices

Floats = NDArray[np.float64]

ROUNDS = 40
RELATIVE_STEP = 1e-4  # a ball that shrinks by less is done


def measure_reach(vertices: Vertices, normals: Floats, largest_mm: float) -> Floats:
    """Radius of the largest ball that touches the surface from inside at each vertex and holds no other vertex, (V,) mm.

    vertices (V, 3) mm, normals (V, 3) unit, outward. Radii are capped at `largest_mm`. O(V log V).
    Source: shrinking balls, Ma, Bae & Choi 2012, doi:10.1007/s00371-011-0594-7.
    """
    tree = cKDTree(vertices)
    radius = np.full(len(vertices), largest_mm)
    active = np.arange(len(vertices))
    for _ in range(ROUNDS):
        centre = vertices[active] - radius[active, None] * normals[active]
        distance, found = tree.query(centre)
        nearest = np.asarray(found, dtype=np.int64)
        holds = (distance < radius[active] * (1 - 1e-6)) & (nearest != active)
        active, nearest = active[holds], nearest[holds]
        apart = vertices[active] - vertices[nearest]
        across = 2 * np.einsum("ij,ij->i", apart, normals[active])
        touching = np.einsum("ij,ij->i", apart, apart) / np.maximum(across, 1e-12)
        shrunk = touching < radius[active] * (1 - RELATIVE_STEP)
        radius[active] = np.minimum(radius[active], touching)
        active = active[shrunk]
        if len(active) == 0:
            break
    return radius
