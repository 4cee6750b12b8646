"""The spaces that closed surfaces part, each with the pieces of surface around and inside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.containment import is_inside
from core.geometry.face_tree import FaceTree
from core.geometry.volume import signed_volumes
from core.mesh import Mesh


@dataclass(frozen=True, eq=False, slots=True)
class Piece:
    """A connected part of one surface. surface: its number; faces: (F, 3), numbers in the vertices of all surfaces together;
    volume_mm3: enclosed, below 0 for the wall of a cavity."""

    surface: int
    faces: NDArray[np.int64]
    volume_mm3: float


@dataclass(frozen=True, slots=True)
class Space:
    """Numbers of pieces: the one around it, and those directly inside. region: the surface whose tissue fills it."""

    region: int
    around: int
    inside: tuple[int, ...]


def find_pieces(surfaces: Mapping[str, Mesh]) -> tuple[Piece, ...]:
    """In the order of the surfaces."""
    pieces: list[Piece] = []
    start = 0
    for number, mesh in enumerate(surfaces.values()):
        count, label = face_components(edges(mesh.faces))
        volumes = signed_volumes(mesh.vertices, mesh.faces, label)
        pieces += [
            Piece(number, mesh.faces[label == piece].astype(np.int64) + start, float(volumes[piece])) for piece in range(count)
        ]
        start += len(mesh.vertices)
    return tuple(pieces)


def find_spaces(
    vertices: NDArray[np.float64], pieces: tuple[Piece, ...], surfaces: Mapping[str, Mesh], nesting: Mapping[str, str | None]
) -> tuple[Space, ...]:
    """Every space but the one around all pieces and cavities of the outermost, which are air.

    Needs: closed pieces that touch nowhere; nesting: name -> the surface around it; vertices of all surfaces together.
    """
    names = list(surfaces)
    holders = _find_holders(vertices, pieces)
    spaces: list[Space] = []
    for number, piece in enumerate(pieces):
        around = nesting[names[piece.surface]]
        if piece.volume_mm3 < 0 and around is None:
            continue
        region = piece.surface if piece.volume_mm3 > 0 or around is None else names.index(around)
        spaces.append(Space(region, number, tuple(inner for inner, holder in enumerate(holders) if holder == number)))
    return tuple(spaces)


def _find_holders(vertices: NDArray[np.float64], pieces: tuple[Piece, ...]) -> list[int | None]:
    """For each piece the smallest that encloses it; none of its vertices may lie on another."""
    points = vertices[[piece.faces[0, 0] for piece in pieces]]
    sizes = np.array([abs(piece.volume_mm3) for piece in pieces])
    holders: list[int | None] = [None] * len(pieces)
    for number in np.argsort(-sizes, kind="stable").tolist():  # smaller ones come later and overwrite
        smaller = np.flatnonzero(sizes < sizes[number])
        if len(smaller):
            tree = FaceTree.of(vertices, pieces[number].faces)
            for inner in smaller[is_inside(tree, points[smaller])].tolist():
                holders[inner] = number
    return holders
