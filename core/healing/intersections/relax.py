"""New places for the vertices of a patch: as smooth a continuation of the surface around it as there is."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.sparse.linalg import splu

from core.geometry.adjacency import edges
from core.geometry.components import label_connected
from core.mesh import Faces, Vertices

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]


def relax(vertices: Vertices, faces: Faces, free: Flags, order: int) -> Vertices:
    """Solve for the free vertices (V,): order 1 spans a skin over the rim of the patch, 2 also keeps its slope at the rim.

    Weights are uniform, so that faces become even, however crooked they were. Rounded to float32. A part without any fixed
    vertex stays as it is.
    """
    around = free.copy()
    for _ in range(order):
        around[faces[around[faces].any(axis=1)]] = True
    local = np.flatnonzero(around)
    number = np.full(len(vertices), -1, dtype=np.int64)
    number[local] = np.arange(len(local))
    inner = number[faces[around[faces].any(axis=1)]]
    inner = inner[(inner >= 0).all(axis=1)]
    held = _is_held(inner, free[local])
    laplacian = _laplacian(inner.astype(np.int32), len(local))
    unknown, known = np.flatnonzero(held & free[local]), np.flatnonzero(~free[local])
    if len(unknown) == 0:
        return vertices.copy()
    summed = np.zeros(len(vertices), dtype=np.bool_)
    summed[local[unknown]] = True
    if order == 2:  # the rows of the outermost ring are incomplete: the energy is summed over free vertices and neighbours
        summed[faces[summed[faces].any(axis=1)]] = True
    rows = laplacian[np.flatnonzero(summed[local])]
    left, right = rows[:, unknown], -rows[:, known] @ vertices[local[known]]
    if order == 2:
        left, right = left.T @ left, left.T @ right
    moved = vertices.copy()
    solved = splu(left.tocsc()).solve(np.ascontiguousarray(right))
    moved[local[unknown]] = solved.astype(np.float32)
    return moved


def _is_held(faces: Ints, free: Flags) -> Flags:
    """Vertices that hang together with one that is not free."""
    _, part = label_connected(len(free), faces.ravel(), np.roll(faces, -1, axis=1).ravel())
    held: Flags = np.isin(part, part[~free])
    return held


def _laplacian(faces: Faces, count: int) -> csr_array:
    """Mean of the neighbours less the vertex itself, as a matrix (count, count)."""
    ends = edges(faces).ends
    ones = np.ones(len(ends))
    one_way = coo_array((ones, (ends[:, 0], ends[:, 1])), shape=(count, count)).tocsr()
    links = one_way + one_way.T
    valence = np.maximum(np.asarray(links.sum(axis=1)).ravel(), 1.0)
    return (diags_array(1.0 / valence) @ links - diags_array(np.ones(count))).tocsr()
