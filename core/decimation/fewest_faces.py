"""The fewest triangles a closed surface of some genus can be made of."""

from __future__ import annotations

import math

import numpy as np

from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.mesh import Faces


def fewest_faces(faces: Faces) -> int:
    """For closed oriented manifolds in any number of pieces, faces (F, 3): no triangulation of that topology has fewer."""
    table = edges(faces)
    count, label = face_components(table)
    face_count = np.bincount(label, minlength=count)
    piece = np.empty(int(faces.max()) + 1, dtype=np.int64)
    piece[faces] = label[:, None]
    vertex_count = np.bincount(piece[np.unique(faces)], minlength=count)
    # a closed piece has three sides to two faces
    characteristic = vertex_count - face_count // 2
    return sum(fewest_of_genus(1 - int(chi) // 2) for chi in characteristic)


def fewest_of_genus(genus: int) -> int:
    """4 for a sphere, 14 for a torus. Source: Jungerman & Ringel 1980, doi:10.1007/BF02414187; genus 2 takes one vertex more."""
    vertices = math.ceil((7 + math.sqrt(1 + 48 * genus)) / 2) + (genus == 2)
    return 2 * (vertices - 2 + 2 * genus)
