"""Where a surface is the outside of a thin sheet, as a pinna is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Floats = NDArray[np.float64]

FACING = -0.5  # normals less than 60 degrees from opposite bound a sheet
BELOW = 0.5  # the other side lies within 60 degrees of straight below


def find_thin_sheets(points: Floats, normals: Floats, thinner_than_mm: float) -> NDArray[np.bool_]:
    """True for points (N, 3) mm with outward unit normals (N, 3) that have the surface's other side less than
    `thinner_than_mm` below them, (N,). Sampled at the points: reliable where these lie closer than that."""
    pairs = cKDTree(points).query_pairs(thinner_than_mm, output_type="ndarray")
    first, second = pairs.T
    apart = points[second] - points[first]
    length = np.linalg.norm(apart, axis=1)
    facing = np.einsum("ij,ij->i", normals[first], normals[second]) < FACING
    below_first = np.einsum("ij,ij->i", apart, normals[first]) < -BELOW * length
    below_second = np.einsum("ij,ij->i", apart, normals[second]) > BELOW * length
    thin = np.zeros(len(points), dtype=np.bool_)
    thin[first[facing & below_first]] = True
    thin[second[facing & below_second]] = True
    return thin
