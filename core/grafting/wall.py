"""How far points lie outside or inside of the boxes of a region."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Box = tuple[Sequence[float], Sequence[float]]  # lowest and highest corner, mm


def wall_distance(points: Floats, boxes: Sequence[Box]) -> Floats:
    """Signed distance in mm of points (N, 3) to the walls of the nearest of the boxes, (N,): negative inside.

    Measured along the axes (largest of the three), so points at one distance lie on a larger or smaller box.
    """
    distances = [
        np.maximum(np.asarray(low, dtype=float) - points, points - np.asarray(high, dtype=float)).max(axis=1)
        for low, high in boxes
    ]
    nearest: Floats = np.min(distances, axis=0)
    return nearest
