"""Folds no wider than a rounding error: the short edge in them is collapsed, and nothing else moves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.healing.change import Change, Staged
from core.mesh import Faces, Vertices

Ints = NDArray[np.int64]

SHORT_SHARE = 1e-3  # of the median edge around: no shape that anybody meant is as small


def collapse_short_edges(vertices: Vertices, faces: Faces, bad: Ints) -> Staged:
    """Collapse edges of the bad faces (K,) that are far shorter than those around, onto the vertex with the lower number.

    Only where exactly two vertices are joined to both ends (link condition), so that the surface stays what it is.
    Source: Dey, Edelsbrunner, Guha, Nekhayev 1999 (link condition).
    """
    corners = vertices[faces[bad]]
    lengths = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)
    row, side = np.nonzero(lengths < SHORT_SHARE * _usual_edge(vertices, faces, bad))
    ends = np.sort(np.column_stack((faces[bad[row], side], faces[bad[row], (side + 1) % 3])), axis=1)
    places, distances = [], []
    for kept, gone in np.unique(ends, axis=0).tolist():
        joined = _collapse(faces, kept, gone)
        if joined is not None:
            faces = joined
            places.append(vertices[gone])
            distances.append(float(np.linalg.norm(vertices[gone] - vertices[kept])))
    if not places:
        return vertices, faces, []
    message = f"{len(places)} edges of at most {max(distances):.2g} mm in folds were collapsed"
    return vertices, faces, [Change("short_edges", message, np.array(places), np.array(distances))]


def _usual_edge(vertices: Vertices, faces: Faces, bad: Ints) -> float:
    around = faces[np.isin(faces, faces[bad]).any(axis=1)]
    corners = vertices[around]
    return float(np.median(np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2)))


def _collapse(faces: Faces, kept: int, gone: int) -> Faces | None:
    """The faces with one vertex merged into another; None if they are no neighbours (any more) or the link condition fails."""
    has_kept, has_gone = (faces == kept).any(axis=1), (faces == gone).any(axis=1)
    if int((has_kept & has_gone).sum()) != 2:
        return None
    shared = np.intersect1d(faces[has_kept], faces[has_gone])
    if len(shared) != 4:  # the ends and the two vertices opposite
        return None
    joined: Faces = faces[~(has_kept & has_gone)].copy()
    joined[joined == gone] = kept
    around = np.sort(joined[(joined == kept).any(axis=1)], axis=1)
    return joined if len(np.unique(around, axis=0)) == len(around) else None  # of a tetrahedron two equal faces are left
