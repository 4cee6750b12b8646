"""Normals and areas of faces, normals at vertices."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]


def face_crosses(vertices: Vertices, faces: Faces) -> Floats:
    """Cross products of two sides, (F, 3) mm²: the direction of the normal, twice the area long."""
    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    u, v = b - a, c - a
    crosses: Floats = np.empty_like(u)
    # written out: np.cross costs three times as much
    crosses[:, 0] = u[:, 1] * v[:, 2] - u[:, 2] * v[:, 1]
    crosses[:, 1] = u[:, 2] * v[:, 0] - u[:, 0] * v[:, 2]
    crosses[:, 2] = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return crosses


def normalised(vectors: Floats) -> Floats:
    """Vectors (N, 3) scaled to length 1; a zero vector stays zero."""
    lengths = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))
    lengths[lengths == 0.0] = 1.0
    units: Floats = vectors / lengths[:, None]
    return units


def face_normals(vertices: Vertices, faces: Faces) -> Floats:
    """Unit normals, (F, 3); zero for a face without area."""
    return normalised(face_crosses(vertices, faces))


def face_areas(vertices: Vertices, faces: Faces) -> Floats:
    """Areas, (F,) mm²."""
    crosses = face_crosses(vertices, faces)
    areas: Floats = 0.5 * np.sqrt(np.einsum("ij,ij->i", crosses, crosses))
    return areas


def corner_angles(vertices: Vertices, faces: Faces) -> Floats:
    """Inner angles in radians, (F, 3), in the order of the corners; zeros for a face without area."""
    crosses = face_crosses(vertices, faces)
    doubled_areas = np.sqrt(np.einsum("ij,ij->i", crosses, crosses))
    angles: Floats = np.empty(faces.shape)
    for corner in range(3):
        tip, left, right = (vertices[faces[:, (corner + turn) % 3]] for turn in range(3))
        angles[:, corner] = np.arctan2(doubled_areas, np.einsum("ij,ij->i", left - tip, right - tip))
    angles[doubled_areas == 0.0] = 0.0
    return angles


def mean_normals(vertices: Vertices, faces: Faces, weighting: Literal["area", "angle", "inverse_area"] = "angle") -> Floats:
    """Weighted mean of the unit normals around each vertex, (V, 3); shorter than 1 where the surface bends.

    `inverse_area` is n0 of thesis Eq. 4.1, `angle` depends least on how the surface is cut into faces. Faces without
    area have no say; a vertex without other faces gets zero.
    """
    crosses = face_crosses(vertices, faces)
    doubled_areas = np.sqrt(np.einsum("ij,ij->i", crosses, crosses))
    units = normalised(crosses)
    if weighting == "angle":
        weights = corner_angles(vertices, faces)
    else:
        with np.errstate(divide="ignore"):
            per_face = doubled_areas if weighting == "area" else np.where(doubled_areas > 0.0, 1.0 / doubled_areas, 0.0)
        weights = np.repeat(per_face[:, None], 3, axis=1)
    corners = faces.ravel()
    total = np.bincount(corners, weights=weights.ravel(), minlength=len(vertices))
    sums = np.column_stack(
        [np.bincount(corners, weights=(weights * units[:, axis, None]).ravel(), minlength=len(vertices)) for axis in range(3)]
    )
    total[total == 0.0] = 1.0
    means: Floats = sums / total[:, None]
    return means


def vertex_normals(vertices: Vertices, faces: Faces, weighting: Literal["area", "angle", "inverse_area"] = "angle") -> Floats:
    """Unit normals at the vertices, (V, 3); zero where the faces around cancel out or have no area."""
    return normalised(mean_normals(vertices, faces, weighting))
