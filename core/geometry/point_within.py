"""Points just below or above closed surfaces, that stand for the space there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.containment import is_inside
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas, face_normals
from core.geometry.volume import signed_volumes
from core.mesh import Mesh

Points = NDArray[np.float64]
CANDIDATES = 64  # largest faces of a piece that are tried


def find_points_within(mesh: Mesh, gap_mm: float) -> tuple[Points, Points]:
    """Points (N, 3) in what the mesh encloses, one per piece, and (M, 3) in its cavities, one per cavity.

    Each lies a quarter of the gap from the middle of a large face: nearer than any other surface, if those keep `gap_mm`.
    A piece whose largest faces have no room that deep gets none.
    Needs: closed, consistently oriented.
    """
    vertices, faces = mesh.vertices, mesh.faces
    count, label = face_components(edges(faces))
    if count == 0:
        return np.empty((0, 3)), np.empty((0, 3))
    volumes = signed_volumes(vertices, faces, label)
    tree = FaceTree.of(vertices, faces)
    largest_first = np.argsort(-face_areas(vertices, faces), kind="stable")
    within: list[Points] = []
    cavities: list[Points] = []
    for piece in range(count):
        chosen = largest_first[label[largest_first] == piece][:CANDIDATES]
        shift = 0.25 * gap_mm * face_normals(vertices, faces[chosen])
        middles = vertices[faces[chosen]].mean(axis=1)
        is_piece = volumes[piece] > 0
        points = middles - shift if is_piece else middles + shift
        fitting = points[is_inside(tree, points) == is_piece]
        (within if is_piece else cavities).extend(fitting[:1])
    return np.array(within).reshape(-1, 3), np.array(cavities).reshape(-1, 3)
