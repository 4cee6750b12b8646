"""Places inside the faces of a coarse surface, as dense as the faces of the fine one it stands for."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

MOST_PER_SIDE = 12  # a face is sampled in the middles of at most 12 x 12 equal parts
AT_ONCE = 1 << 20  # samples held in memory together


def measure_densely(result: Mesh, original: FaceTree, spacing_mm: float) -> Floats:
    """The largest distance of each face of the result from the original, (F',) mm.

    Each face is cut into n x n equal triangles not larger than those of side `spacing_mm`, and measured in their middles.
    """
    areas = face_areas(result.vertices, result.faces)
    parts = np.ceil(np.sqrt(areas / (0.433 * spacing_mm**2))).astype(np.int64)
    parts = np.clip(parts, 1, MOST_PER_SIDE)
    worst = np.zeros(len(result.faces))
    for count in np.unique(parts):
        weights = _middles(int(count))
        faces = np.flatnonzero(parts == count)
        step = max(1, AT_ONCE // len(weights))
        for start in range(0, len(faces), step):
            some = faces[start : start + step]
            places = np.einsum("sc,fcx->fsx", weights, result.vertices[result.faces[some]])
            distance, _point, _face = closest_points_in(original, places.reshape(-1, 3))
            worst[some] = distance.reshape(len(some), -1).max(axis=1)
    return worst


def _middles(count: int) -> Floats:
    """Barycentric weights of the middles of count x count equal parts of a triangle, (count², 3)."""
    rows = [
        ((i + third) / count, (j + third) / count)
        for turned, third in ((0, 1 / 3), (1, 2 / 3))
        for i in range(count)
        for j in range(count - i - turned)
    ]
    first = np.array(rows)
    return np.column_stack((first, 1.0 - first.sum(axis=1)))
