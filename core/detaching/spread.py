"""Places all over faces, where distances are measured that corners alone would miss."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.mesh import Vertices

Floats = NDArray[np.float64]

SAMPLES = 6  # along each side of a face


def spread_over(vertices: Vertices, faces: NDArray[np.integer]) -> Floats:
    """Places on faces (F, 3), corners and sides included, the same number on each; (F K, 3) mm."""
    share = np.array([(i, j, SAMPLES - i - j) for i in range(SAMPLES + 1) for j in range(SAMPLES + 1 - i)]) / SAMPLES
    places: Floats = np.einsum("sc,fcx->fsx", share, vertices[faces]).reshape(-1, 3)
    return places
