"""Which way faces look: neighbours alike, pieces outward, cavities into their hollow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.containment import is_inside
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.orientation import find_faces_to_flip
from core.geometry.volume import signed_volumes
from core.healing.change import Change, Staged
from core.healing.twists import cut_twists
from core.mesh import Faces, Vertices

Ints = NDArray[np.int64]

DISAGREED = "faces that disagreed with their neighbours were turned over"


def agree(vertices: Vertices, faces: Faces) -> Staged:
    """Flip the fewest faces so that neighbours look alike. Needs edges with at most two faces.

    Where a surface is one-sided because of a few faces, those are taken out.
    Raises: InputError `heal.one_sided`.
    """
    turned = find_faces_to_flip(edges(faces))
    cut: list[Change] = []
    if turned is None:
        vertices, faces, cut = cut_twists(vertices, faces)
        turned = find_faces_to_flip(edges(faces)) if cut else None
    if turned is None:
        raise InputError(
            "heal.one_sided",
            "the surface is one-sided, like a Möbius strip: it has no inside, so it cannot be made into a body",
            faces=len(faces),
        )
    vertices, faces, flipped = _flipped(vertices, faces, turned, "turned_faces", DISAGREED)
    return vertices, faces, cut + flipped


def agree_within_sheets(vertices: Vertices, faces: Faces) -> Staged:
    """The same where edges have more than two faces: those are no neighbours, and a one-sided sheet is left as it is."""
    turned = find_faces_to_flip(edges(faces))
    if turned is None:
        return vertices, faces, []
    return _flipped(vertices, faces, turned, "turned_faces", DISAGREED)


def face_outward(vertices: Vertices, faces: Faces) -> Staged:
    """Turn over closed pieces that look inward, and cavities that do not look into their hollow.

    Needs agreement of neighbours; open pieces are left alone. Pieces that run through each other are taken for parts of
    one body, so neither is a cavity of the other.
    """
    found = edges(faces)
    count, piece = face_components(found)
    open_pieces = np.unique(piece[(found.face_count[found.of_face] != 2).any(axis=1)])
    depth = _depths(vertices, faces, count, piece, open_pieces) if count > 1 else np.zeros(1, dtype=np.int64)
    wrong = np.sign(signed_volumes(vertices, faces, piece)) == 2.0 * (depth % 2) - 1.0
    wrong[open_pieces] = False
    turned = np.flatnonzero(wrong[piece])
    return _flipped(
        vertices, faces, turned, "inside_out", f"faces of {int(wrong.sum())} pieces that were inside out were turned over"
    )


def _depths(vertices: Vertices, faces: Faces, count: int, piece: Ints, open_pieces: Ints) -> Ints:
    """How many closed pieces hold each piece, without crossing it, (count,)."""
    pairs = np.unique(np.sort(piece[find_intersecting_faces(vertices, faces)], axis=1), axis=0)
    crossing = {(int(a), int(b)) for a, b in pairs}
    probe = vertices[faces[np.unique(piece, return_index=True)[1], 0]]
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = vertices[faces]
    np.minimum.at(low, piece, corners.min(axis=1))
    np.maximum.at(high, piece, corners.max(axis=1))
    depth = np.zeros(count, dtype=np.int64)
    closed = np.setdiff1d(np.arange(count), open_pieces)
    for holder in closed:
        within = (probe >= low[holder]).all(axis=1) & (probe <= high[holder]).all(axis=1)
        within[holder] = False
        asked = np.array([p for p in np.flatnonzero(within) if (min(p, holder), max(p, holder)) not in crossing], dtype=np.int64)
        if len(asked):
            depth[asked] += is_inside(FaceTree.of(vertices, faces[piece == holder]), probe[asked])
    return depth


def _flipped(vertices: Vertices, faces: Faces, turned: Ints, kind: str, what: str) -> Staged:
    """The faces with some turned over; the first corner stays first."""
    if len(turned) == 0:
        return vertices, faces, []
    changed = faces.copy()
    changed[turned] = faces[turned][:, [0, 2, 1]]
    points = vertices[faces[turned]].mean(axis=1)
    return vertices, changed, [Change(kind, f"{len(turned)} {what}", points, np.zeros(len(turned)))]
