"""How wide a slit is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.detaching.slab import END, FIRST, SECOND
from core.detaching.spread import spread_over
from core.geometry.distance import closest_points_in, smallest_gap_between
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def measure_slit(mesh: Mesh, piece: Ints, off_end_mm: float) -> tuple[float, float]:
    """Smallest and mean distance between the two walls of a slit, mm.

    piece: (F,) FIRST, SECOND, END or else. Where the slit ends within the body its walls meet: what lies within off_end_mm of
    that end does not count. The smallest is exact between faces away from it, and sampled on faces next to it."""
    walls = [mesh.faces[piece == number] for number in (FIRST, SECOND)]
    end = mesh.faces[piece == END]
    if any(len(wall) == 0 for wall in walls):
        return 0.0, 0.0
    trees = [FaceTree.of(mesh.vertices, wall) for wall in walls]
    end_tree = FaceTree.of(mesh.vertices, end) if len(end) else None
    smallest, sums, count = np.inf, 0.0, 0
    away = []
    for wall, other in zip(walls, trees[::-1], strict=True):
        places = spread_over(mesh.vertices, wall)
        far = _is_far(end_tree, places, off_end_mm)
        away.append(wall[far.reshape(len(wall), -1).all(axis=1)])
        if far.any():
            distance = closest_points_in(other, places[far])[0]
            smallest, sums, count = min(smallest, float(distance.min())), sums + float(distance.sum()), count + len(distance)
    if all(len(wall) for wall in away):
        first, second = (FaceTree.of(mesh.vertices, wall) for wall in away)
        smallest = min(smallest, smallest_gap_between(first, second).distance_mm)
    return (float(smallest), sums / count) if count else (0.0, 0.0)


def _is_far(tree: FaceTree | None, places: Floats, limit_mm: float) -> NDArray[np.bool_]:
    if tree is None:
        return np.ones(len(places), dtype=np.bool_)
    far: NDArray[np.bool_] = closest_points_in(tree, places)[0] > limit_mm
    return far
