"""Which faces intersect, decided by exact arithmetic (libigl over CGAL)."""

from __future__ import annotations

import igl.copyleft.cgal
import numpy as np
from numpy.typing import NDArray

from core.geometry.coincidence import find_equal_face_pairs, position_ids
from core.geometry.fan_intersections import find_fan_faces, find_intersections_of_fans
from core.geometry.folded_faces import find_folded_pairs
from core.mesh import Faces, Mesh, Vertices

Pairs = NDArray[np.int64]

EDGE = 2  # places that neighbours share


def find_intersecting_faces(vertices: Vertices, faces: Faces) -> Pairs:
    """Pairs of faces that meet other than in shared corners and edges.

    vertices: (V, 3) mm. faces: (F, 3). Returns (K, 2), lower face number first, sorted: equal input, equal output.
    A corner or edge counts as shared when the places are equal, whatever the vertex numbers, so faces that merely
    touch at equal points are not listed: measure the gap as well. A corner that lies inside another face or edge,
    coplanar overlap, folding over along a shared edge and doubled faces are listed.
    Faces of exactly zero area are not tested: find them with `core.geometry.degenerate`.

    Source: libigl `remesh_self_intersections` (Attene-style exact constructions in CGAL). That call skips faces over
    the same three places as its caller's business; they are added here. Of faces that share an edge it takes points in a plane
    by constructions that round, so those pairs are decided by `find_folded_pairs`. It compares all faces at a corner with
    each other, so those around a corner of very many are left to `find_intersections_of_fans`.
    """
    vertices = np.ascontiguousarray(vertices, dtype=np.float64)
    places = position_ids(vertices)[faces]
    in_fan = find_fan_faces(places)
    plain = np.flatnonzero(~in_fan)
    parts = [
        _between_plain_faces(vertices, faces, places, plain),
        find_folded_pairs(vertices[faces], places, plain),
        find_equal_face_pairs(places),
    ]
    if in_fan.any():
        parts.append(find_intersections_of_fans(vertices, faces, places, in_fan))
    return np.unique(np.concatenate(parts), axis=0)


def _between_plain_faces(vertices: Vertices, faces: Faces, places: Pairs, chosen: Pairs) -> Pairs:
    """Pairs of the chosen faces (K,) that share at most a corner; their order differs from run to run, the call is threaded."""
    if not len(chosen):
        return np.empty((0, 2), dtype=np.int64)
    found = igl.copyleft.cgal.remesh_self_intersections(vertices, faces[chosen].astype(np.int64), detect_only=True)[2]
    pairs: Pairs = chosen[np.sort(found, axis=1)]
    shared = (places[pairs[:, 0]][:, :, None] == places[pairs[:, 1]][:, None, :]).sum(axis=(1, 2))
    plain: Pairs = pairs[shared < EDGE]
    return plain


def find_intersecting_faces_between(a: Mesh, b: Mesh) -> Pairs:
    """Pairs (face of a, face of b) that meet other than in corners and edges at equal places; (K, 2), sorted."""
    vertices = np.concatenate((a.vertices, b.vertices))
    faces = np.concatenate((a.faces, b.faces + np.int32(len(a.vertices))))
    pairs = find_intersecting_faces(vertices, faces)
    across = pairs[(pairs[:, 0] < len(a.faces)) & (pairs[:, 1] >= len(a.faces))]
    across[:, 1] -= len(a.faces)
    return across
