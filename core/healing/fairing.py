"""Vertices of patches are placed so that the patch bends on as the surface around it does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, diags_array
from scipy.sparse.linalg import splu

from core.geometry.adjacency import edges
from core.mesh import Faces

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

SMALLEST_COTANGENT = 0.02  # weights below it, or negative, would let vertices leave their ring
LARGEST_COTANGENT = 50.0


def fair(points: Floats, faces: Faces, free: Flags, order: int) -> Floats:
    """Move the free points (P,) to where the energy is least; the others stay.

    faces: (F, 3) patches and the faces around their rims. order: 1 for the membrane of least stretch, 2 for the thin plate of
    least bending, which goes on with the curvature of the faces around.
    Source: Botsch & Kobbelt 2004, doi:10.1145/1015706.1015772 (cotangent weights, linear system).
    """
    if not free.any():
        return points
    stiffness, mass = _laplacian(points, faces)
    rows = np.zeros(len(points), dtype=np.bool_)
    rows[faces[free[faces].any(axis=1)].ravel()] = True  # the free points and their rims
    if order == 2:
        part = stiffness[rows]
        stiffness = csc_array(part.T @ diags_array(1.0 / mass[rows]) @ part)
    inner = stiffness[free]
    moved = points.copy()
    moved[free] = splu(csc_array(inner[:, free])).solve(-(inner[:, ~free] @ points[~free]))
    return moved


def spread(points: Floats, faces: Faces, free: Flags) -> Floats:
    """Move the free points (P,) so that each lies in the middle of its neighbours; the others stay."""
    if not free.any():
        return points
    ends = edges(faces).ends
    weight = np.ones(len(ends))
    one_way = coo_array((weight, (ends[:, 0], ends[:, 1])), shape=(len(points), len(points))).tocsc()
    graph = one_way + one_way.T
    inner = csc_array(diags_array(graph.sum(axis=0)) - graph)[free]
    moved = points.copy()
    moved[free] = splu(csc_array(inner[:, free])).solve(-(inner[:, ~free] @ points[~free]))
    return moved


def _laplacian(points: Floats, faces: Faces) -> tuple[csc_array, Floats]:
    """Cotangent stiffness (P, P) and a third of the area around each point (P,)."""
    count = len(points)
    first, second, weight = [], [], []
    corners = points[faces]
    doubled = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    tiny = 1e-12 * max(float(doubled.max()), 1e-300)
    for turn in range(3):
        tip, a, b = (corners[:, (turn + step) % 3] for step in range(3))
        cotangent = np.einsum("ij,ij->i", a - tip, b - tip) / np.maximum(doubled, tiny)
        first.append(faces[:, (turn + 1) % 3])
        second.append(faces[:, (turn + 2) % 3])
        weight.append(np.clip(cotangent, SMALLEST_COTANGENT, LARGEST_COTANGENT) / 2.0)
    a, b, w = np.concatenate(first), np.concatenate(second), np.concatenate(weight)
    degree = np.bincount(a, w, minlength=count) + np.bincount(b, w, minlength=count)
    rows = np.concatenate((a, b, np.arange(count)))
    columns = np.concatenate((b, a, np.arange(count)))
    stiffness = coo_array((np.concatenate((w, w, -degree)), (rows, columns)), shape=(count, count)).tocsc()
    mass = np.bincount(faces.ravel(), np.repeat(np.maximum(doubled, tiny) / 6.0, 3), minlength=count)
    return stiffness, np.maximum(mass, tiny)
