"""Vertices at one place and faces over one place: what an exact intersection test takes for shared corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.mesh import Faces, Vertices


def position_ids(vertices: Vertices) -> NDArray[np.int64]:
    """Give vertices at the same place the same number.

    vertices: (V, 3) mm. Returns (V,): the lowest vertex number at that place, so a mesh without coincident vertices
    gets 0..V-1. Equality is that of the numbers: -0.0 equals 0.0, and nothing is rounded.
    """
    order = np.lexsort(vertices.T[::-1])  # stable: the lowest vertex number comes first in each group
    ordered = vertices[order]
    starts = np.ones(len(vertices), dtype=bool)
    starts[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    ids = np.empty(len(vertices), dtype=np.int64)
    ids[order] = order[starts][np.cumsum(starts) - 1]
    return ids


def group_equal_faces(faces: NDArray[np.integer]) -> NDArray[np.int64]:
    """Give faces over the same three corners, in any order or direction, the same number.

    faces: (F, 3), for instance `position_ids(vertices)[faces]`. Returns (F,): the lowest face number of the group.
    """
    corners = np.sort(faces.astype(np.int64), axis=1)
    order = np.lexsort((corners[:, 2], corners[:, 1], corners[:, 0]))
    ordered = corners[order]
    starts = np.ones(len(faces), dtype=bool)
    starts[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    groups = np.empty(len(faces), dtype=np.int64)
    groups[order] = order[starts][np.cumsum(starts) - 1]
    return groups


def find_equal_face_pairs(faces: Faces | NDArray[np.int64]) -> NDArray[np.int64]:
    """All pairs of faces over the same corners.

    faces: (F, 3). Returns (K, 2), lower number first, sorted; n equal faces give n(n-1)/2 pairs.
    Faces that repeat a corner are left out: they are degenerate, not doubled.
    """
    groups = group_equal_faces(faces)
    proper = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    repeated = np.flatnonzero(proper & (groups != np.arange(len(faces))))
    pairs = []
    for first in np.unique(groups[repeated]):
        members = np.concatenate(([first], repeated[groups[repeated] == first]))
        lower, higher = np.triu_indices(len(members), 1)
        pairs.append(np.column_stack((members[lower], members[higher])))
    if not pairs:
        return np.empty((0, 2), dtype=np.int64)
    found = np.concatenate(pairs)
    return found[np.lexsort((found[:, 1], found[:, 0]))]
