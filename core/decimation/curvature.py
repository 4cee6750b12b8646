"""The thesis' measure of curvature (3.2): how far the normal of a face is from those of its neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.normals import face_normals
from core.mesh import Mesh


def mean_neighbour_angles_deg(mesh: Mesh) -> NDArray[np.float64]:
    """Mean angle between the normal of each face and those of the faces across its sides, (F,) degrees, 0 without any.

    Not folded into [0, 90] as in the thesis' script (`subspace`): a sharp ridge is curved, not flat. Faces meet where two
    of them share an edge; other edges have no say.
    """
    normals = face_normals(mesh.vertices, mesh.faces)
    _edge, face, _side = edges(mesh.faces).two_faces()
    first, second = normals[face[:, 0]], normals[face[:, 1]]
    # the half-angle form keeps the digits of small angles
    angle = 2.0 * np.arctan2(np.linalg.norm(first - second, axis=1), np.linalg.norm(first + second, axis=1))
    count = np.bincount(face.ravel(), minlength=len(mesh.faces))
    total = np.bincount(face.ravel(), weights=np.repeat(angle, 2), minlength=len(mesh.faces))
    means: NDArray[np.float64] = np.degrees(total / np.maximum(count, 1))
    return means
