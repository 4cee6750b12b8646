"""Angles between neighbouring faces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Edges
from core.geometry.normals import face_crosses
from core.mesh import Faces, Vertices


def dihedral_angles(
    vertices: Vertices, faces: Faces, edges: Edges
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Angle between the two faces at each edge that has two, in degrees: 180 flat, 0 folded onto itself.

    Returns edge (N,), faces (N, 2), angle (N,) within 0..180: which side is the inside plays no part, nor does the
    orientation of the faces. Edges with a face without area are left out.
    """
    edge, pair, side = edges.two_faces()
    crosses = face_crosses(vertices, faces)
    has_area = (crosses != 0.0).any(axis=1)
    keep = has_area[pair].all(axis=1)
    edge, pair, side = edge[keep], pair[keep], side[keep]
    first, second = crosses[pair[:, 0]], crosses[pair[:, 1]].copy()
    same_way = edges.forward[pair[:, 0], side[:, 0]] == edges.forward[pair[:, 1], side[:, 1]]
    second[same_way] *= -1.0
    sine = np.linalg.norm(np.cross(first, second), axis=1)
    angle: NDArray[np.float64] = 180.0 - np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", first, second)))
    return edge, pair, angle
