"""Where a join does not fit, and more room for it there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.dihedral import dihedral_angles
from core.geometry.exact_intersection import find_intersecting_faces
from core.grafting.pairing import Pieces
from core.grafting.piece import Piece
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

SHARPEST_FOLD_DEG = 1.0  # between a band and what is beside it; sharper folds are as good as crossings to a mesher


def find_misfits(joined: Mesh, base_faces: int, donor_faces: int) -> Ints:
    """Faces (K,) of a join that intersect others, exactly, or are folded onto a neighbour of the band.

    The first `base_faces` faces are the base's, the donor's follow, then the bands. Looked at is all around donor and bands.
    """
    corners = joined.triangles()
    low, high = corners.min(axis=1), corners.max(axis=1)
    near = (low <= high[base_faces:].max(axis=0)).all(axis=1) & (high >= low[base_faces:].min(axis=0)).all(axis=1)
    chosen = np.flatnonzero(near)
    crossing = find_intersecting_faces(joined.vertices, joined.faces[chosen])
    _edge, pair, angle = dihedral_angles(joined.vertices, joined.faces[chosen], edges(joined.faces[chosen]))
    in_band = (chosen[pair] >= base_faces + donor_faces).any(axis=1)
    misfits: Ints = chosen[np.unique(np.concatenate((crossing, pair[in_band & (angle < SHARPEST_FOLD_DEG)])))]
    return misfits


def widen(pieces: Pieces, joined: Mesh, misfits: Ints) -> Pieces:
    """Both pieces less the faces around the rim vertices nearest to the faces that do not fit."""
    places = joined.vertices[np.unique(joined.faces[misfits])]
    return _recede(pieces[0], places), _recede(pieces[1], places)


def _recede(piece: Piece, places: Floats) -> Piece:
    rim = np.concatenate(piece.rims)
    distance = np.linalg.norm(places[:, None, :] - piece.mesh.vertices[rim][None, :, :], axis=2)
    return piece.without(np.unique(rim[distance.argmin(axis=1)]))
