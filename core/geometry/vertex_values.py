"""Numbers on the vertices of one surface, asked for at other places."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.distance import closest_points
from core.mesh import Mesh

Floats = NDArray[np.float64]


def interpolate(values: Floats, mesh: Mesh, points: Floats) -> Floats:
    """Linear over the faces of a mesh: at points (N, 3) mm, (N,), the values (V,) of the mesh at the nearest place of it.

    A point that is a vertex of the mesh gets that vertex's value bit for bit. Faces need an area.
    """
    _distance, foot, face = closest_points(mesh.vertices, mesh.faces, points)
    corners = mesh.faces[face]
    weights = _barycentric(mesh.vertices[corners], foot)
    found: Floats = np.einsum("ij,ij->i", weights, values[corners])
    # a sum of three products is not exact, and far from all points are new
    same = (mesh.vertices[corners] == points[:, None, :]).all(axis=2)
    rows, which = np.nonzero(same)
    found[rows] = values[corners[rows, which]]
    return found


def _barycentric(triangles: Floats, points: Floats) -> Floats:
    """Weights (N, 3) of points (N, 3) on triangles (N, 3, 3), kept within them."""
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    w = points - triangles[:, 0]
    uu, uv, vv = (np.einsum("ij,ij->i", a, b) for a, b in ((u, u), (u, v), (v, v)))
    wu, wv = np.einsum("ij,ij->i", w, u), np.einsum("ij,ij->i", w, v)
    area = np.maximum(uu * vv - uv * uv, np.finfo(np.float64).tiny)
    second, third = (vv * wu - uv * wv) / area, (uu * wv - uv * wu) / area
    weights: Floats = np.clip(np.column_stack((1 - second - third, second, third)), 0.0, 1.0)
    weights /= weights.sum(axis=1)[:, None]
    return weights
