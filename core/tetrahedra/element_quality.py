"""Shape of tetrahedra."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
PAIRS = list(combinations(range(4), 2))


def volumes(corners: Floats) -> Floats:
    """Signed volume in mm³ of tetrahedra with corners (T, 4, 3); positive if right-handed."""
    a, b, c = (corners[:, corner] - corners[:, 0] for corner in (1, 2, 3))
    found: Floats = np.einsum("ij,ij->i", np.cross(a, b), c) / 6.0
    return found


def quality(corners: Floats) -> Floats:
    """Volume over the cube of the root mean square edge, scaled to 1 for the regular tetrahedron; 0 if flat, below if inverted.

    Source: Parthasarathy, Graichen, Hathaway 1994, doi:10.1016/0168-874X(94)90033-7.
    """
    squares = sum(((corners[:, i] - corners[:, j]) ** 2).sum(axis=1) for i, j in PAIRS) / len(PAIRS)
    scaled: Floats = 6.0 * np.sqrt(2.0) * volumes(corners) / np.maximum(squares**1.5, np.finfo(float).tiny)
    return scaled


def radius_ratio(corners: Floats) -> Floats:
    """Three radii of the inscribed sphere over that of the circumscribed one: 1 for the regular tetrahedron, 0 if flat."""
    a, b, c = (corners[:, corner] - corners[:, 0] for corner in (1, 2, 3))
    ab, bc, ca = np.cross(a, b), np.cross(b, c), np.cross(c, a)
    six_volumes = np.abs(np.einsum("ij,ij->i", ab, c))
    twice_area = sum(np.linalg.norm(each, axis=1) for each in (ab, bc, ca, np.cross(b - a, c - a)))
    squares = [np.einsum("ij,ij->i", each, each)[:, None] for each in (a, b, c)]
    circle = np.linalg.norm(squares[0] * bc + squares[1] * ca + squares[2] * ab, axis=1)  # its radius times twelve volumes
    scaled: Floats = 6.0 * six_volumes**2 / np.maximum(twice_area * circle, np.finfo(float).tiny)
    return scaled


def smallest_dihedral_deg(corners: Floats) -> Floats:
    """Smallest of the six angles between faces, in degrees; 70.5 for the regular tetrahedron."""
    normals = []
    for opposite in range(4):
        a, b, c = (corners[:, corner] for corner in range(4) if corner != opposite)
        normal = np.cross(b - a, c - a)
        inwards = np.einsum("ij,ij->i", normal, corners[:, opposite] - a)
        normal *= np.where(inwards > 0, -1.0, 1.0)[:, None]
        normals.append(normal / np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)[:, None])
    cosines = [np.einsum("ij,ij->i", normals[i], normals[j]) for i, j in PAIRS]
    smallest: Floats = 180.0 - np.degrees(np.arccos(np.clip(np.min(cosines, axis=0), -1.0, 1.0)))
    return smallest
