"""Which faces intersect, decided by exact arithmetic (libigl over CGAL)."""

from __future__ import annotations

import igl.copyleft.cgal
import numpy as np
from numpy.typing import NDArray

from core.geometry.coincidence import find_equal_face_pairs, position_ids
from core.mesh import Faces, Mesh, Vertices

Pairs = NDArray[np.int64]


def find_intersecting_faces(vertices: Vertices, faces: Faces) -> Pairs:
    """Pairs of faces that meet other than in shared corners and edges.

    vertices: (V, 3) mm. faces: (F, 3). Returns (K, 2), lower face number first, sorted: equal input, equal output.
    A corner or edge counts as shared when the places are equal, whatever the vertex numbers, so faces that merely
    touch at equal points are not listed: measure the gap as well. A corner that lies inside another face or edge,
    coplanar overlap, folding over along a shared edge and doubled faces are listed.
    Faces of exactly zero area are not tested: find them with `core.geometry.degenerate`.

    Source: libigl `remesh_self_intersections` (Attene-style exact constructions in CGAL). That call skips faces over
    the same three places as its caller's business; they are added here.
    """
    found = igl.copyleft.cgal.remesh_self_intersections(
        np.ascontiguousarray(vertices, dtype=np.float64), np.ascontiguousarray(faces, dtype=np.int64), detect_only=True
    )[2]
    # the call is threaded: order within and between pairs differs from run to run
    pairs = np.concatenate((np.sort(found, axis=1), find_equal_face_pairs(position_ids(vertices)[faces])))
    return np.unique(pairs, axis=0)


def find_intersecting_faces_between(a: Mesh, b: Mesh) -> Pairs:
    """Pairs (face of a, face of b) that meet other than in corners and edges at equal places; (K, 2), sorted."""
    vertices = np.concatenate((a.vertices, b.vertices))
    faces = np.concatenate((a.faces, b.faces + np.int32(len(a.vertices))))
    pairs = find_intersecting_faces(vertices, faces)
    across = pairs[(pairs[:, 0] < len(a.faces)) & (pairs[:, 1] >= len(a.faces))]
    across[:, 1] -= len(a.faces)
    return across
