"""Signed volume inside closed surfaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.mesh import Faces, Vertices


def signed_volumes(vertices: Vertices, faces: Faces, labels: NDArray[np.int64]) -> NDArray[np.float64]:
    """Volume in mm³ of each piece, positive if its faces look outward; labels (F,) number the pieces from 0.

    Divergence theorem; meaningful for closed, consistently oriented pieces.
    """
    # from the middle of the mesh, since far from the origin the tetrahedra's volumes would nearly cancel
    a, b, c = ((vertices - vertices.mean(axis=0))[faces[:, corner]] for corner in range(3))
    six_volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    volumes: NDArray[np.float64] = np.bincount(labels, weights=six_volumes) / 6.0
    return volumes
