"""How often a surface, with holes or without, winds around a point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.mesh import Faces, Vertices


def winding_number(vertices: Vertices, faces: Faces, point: NDArray[np.float64]) -> float:
    """Generalised winding number of oriented faces (F, 3) around a point (3,): 1 inside a closed outward surface, 0 outside.

    Source: Van Oosterom & Strackee 1983 (solid angle); Jacobson, Kavan, Sorkine-Hornung 2013, doi:10.1145/2461912.2461916.
    """
    a, b, c = (vertices[faces[:, corner]] - point for corner in range(3))
    la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
    above = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = la * lb * lc
    below += np.einsum("ij,ij->i", a, b) * lc + np.einsum("ij,ij->i", b, c) * la + np.einsum("ij,ij->i", c, a) * lb
    return float(np.arctan2(above, below).sum() / (2.0 * np.pi))
