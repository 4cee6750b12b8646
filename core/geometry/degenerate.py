"""Faces that are no triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.exact_predicates import are_collinear
from core.mesh import Faces, Vertices


def find_degenerate_faces(vertices: Vertices, faces: Faces) -> NDArray[np.int64]:
    """Faces of exactly zero area: a corner twice, or three corners in one line; (K,) face numbers, ascending.

    Decided by exact predicates: a sliver however thin is a triangle still (its quality q tells).
    """
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    return np.flatnonzero(are_collinear(a, b, c))
