"""A sheet that bends as little as it can between the places that are given."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from core.geometry.adjacency import edges

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

PULL = 1e-3  # towards the places the free points had: keeps a sheet that hardly anything holds where the cut was


def fair_sheet(points: Floats, faces: Ints, free: Flags) -> Floats:
    """Move the free points (P,) of a sheet (F, 3) of nearly equal triangles to where it bends least; the others stay.

    Source: thin plate by the squared graph Laplacian (Botsch & Kobbelt 2004, doi:10.1145/1015706.1015772)."""
    if not free.any() or free.all():
        return points
    ends = edges(faces.astype(np.int32)).ends
    count = len(points)
    one_way = coo_array((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(count, count)).tocsc()
    graph = one_way + one_way.T
    degree = np.maximum(np.asarray(graph.sum(axis=0)).ravel(), 1.0)
    laplacian = csc_array(diags_array(np.ones(count)) - diags_array(1.0 / degree) @ graph)
    net = edges(faces.astype(np.int32))
    inner = np.ones(count)
    inner[net.ends[net.face_count == 1]] = 0.0  # at its border a sheet is free to turn
    bending = csc_array(laplacian.T @ diags_array(inner) @ laplacian)
    system = bending[free]
    pull = PULL * diags_array(np.ones(int(free.sum())))
    moved = points.copy()
    moved[free] = splu(csc_array(system[:, free] + pull)).solve(PULL * points[free] - system[:, ~free] @ points[~free])
    return moved
