"""Polygons to triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.schema.finding import Finding, Severity


def fan(corners: NDArray[np.int64], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cut polygons into triangles around their first corner -> (F, 3).

    corners (sum of counts,): vertex numbers of one polygon after the other; counts (N,): corners of each, all >= 3.
    """
    triangles_of = counts - 2
    polygon = np.repeat(np.arange(len(counts)), triangles_of)
    start = np.concatenate([[0], np.cumsum(counts)[:-1]])[polygon]
    step = np.arange(len(polygon)) - np.repeat(np.cumsum(triangles_of) - triangles_of, triangles_of)
    return np.column_stack([corners[start], corners[start + step + 1], corners[start + step + 2]])


def check_polygons(counts: NDArray[np.int64]) -> list[Finding]:
    """Tell that polygons with more than three corners were cut (`mesh.polygons_split`)."""
    larger = counts > 3
    count = int(larger.sum())
    if not count:
        return []
    message = f"{count} of {len(counts)} faces had more than three corners (up to {int(counts.max())}) and were cut into fans"
    return [Finding(code="mesh.polygons_split", severity=Severity.INFO, message=message, count=count)]
