"""Which pieces of a surface stay."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.adjacency import Edges, edges
from core.geometry.components import face_components
from core.geometry.normals import face_areas
from core.healing.borders import border_sides, find_loops
from core.healing.bridging import find_partners
from core.healing.change import Change, Staged
from core.mesh import Faces, Vertices
from core.schema.heal import PiecesPolicy

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

SCRAP_SHARE = 0.01  # of the largest piece's area: an open piece below it is dirt, unless all pieces are to stay
FLATTEST = 0.02  # 6 √π V / A^1.5, 1 for a sphere: an open piece below it is a sheet, and closing it makes no body


def drop_scraps(vertices: Vertices, faces: Faces, policy: PiecesPolicy) -> Staged:
    """Take away open pieces that are small, or so flat that they enclose nothing. The largest piece stays.

    Needs consistent orientation. Raises: InputError `heal.nothing_left`, `heal.open_sheet`.
    """
    require_faces(faces)
    found = edges(faces)
    if not (found.face_count == 1).any():
        return vertices, faces, []
    count, piece = face_components(found)
    area = np.bincount(piece, weights=face_areas(vertices, faces), minlength=count).astype(np.float64)
    is_open = np.bincount(piece[(found.face_count[found.of_face] == 1).any(axis=1)], minlength=count) > 0
    small = (area < SCRAP_SHARE * area.max()) & (policy != "keep_all")
    flat = _roundness(vertices, faces, found, piece, area) < FLATTEST
    largest = int(np.argmax(area))
    if is_open[largest] and flat[largest]:
        raise InputError(
            "heal.open_sheet",
            f"the surface is an open sheet of {area[largest]:.4g} mm² that encloses nothing, so it cannot be closed to a body",
            area_mm2=float(area[largest]),
        )
    unwanted = is_open & (small | flat)
    unwanted[largest] = False
    if unwanted.any():
        unwanted[_islets(vertices, faces, piece, unwanted)] = False
    return take_away(vertices, faces, unwanted[piece], piece, "scraps", "open pieces that enclose nothing were taken away")


def _islets(vertices: Vertices, faces: Faces, piece: Ints, unwanted: Flags) -> Ints:
    """Pieces whose rims belong to a gap of a piece that stays."""
    piece_of_vertex = np.zeros(len(vertices), dtype=np.int64)
    piece_of_vertex[faces] = piece[:, None]
    loops = find_loops(faces)
    partners = find_partners(vertices, loops, np.array([piece_of_vertex[loop[0]] for loop in loops]))
    return np.unique(partners[(~unwanted[partners]).any(axis=1)])


def drop_pieces(vertices: Vertices, faces: Faces, policy: PiecesPolicy, min_share: float) -> Staged:
    """Keep the pieces that the policy asks for; by area."""
    unwanted, piece = find_unwanted(vertices, faces, policy, min_share)
    return take_away(vertices, faces, unwanted[piece], piece, "small_pieces", "pieces were taken away")


def find_unwanted(vertices: Vertices, faces: Faces, policy: PiecesPolicy, min_share: float) -> tuple[Flags, Ints]:
    """Which pieces go (pieces,), and the piece of each face (F,)."""
    count, piece = face_components(edges(faces))
    unwanted = np.zeros(count, dtype=np.bool_)
    if count > 1 and policy != "keep_all":
        area = np.bincount(piece, weights=face_areas(vertices, faces), minlength=count)
        unwanted = area < min_share * area.max()
        if policy == "keep_largest":
            unwanted = np.arange(count) != np.argmax(area)
    return unwanted, piece


def require_faces(faces: Faces) -> None:
    """Raises: InputError `heal.nothing_left`."""
    if len(faces) == 0:
        raise InputError("heal.nothing_left", "nothing is left of the surface: all its faces were degenerate or scraps")


def take_away(vertices: Vertices, faces: Faces, unwanted: Flags, piece: Ints, kind: str, what: str) -> Staged:
    """The faces without some (F,), told piece by piece."""
    if not unwanted.any():
        return vertices, faces, []
    numbers, of_face = np.unique(piece[unwanted], return_inverse=True)
    triangles = vertices[faces[unwanted]]
    middles = triangles.mean(axis=1)
    sizes = np.bincount(of_face)
    points = np.column_stack([np.bincount(of_face, middles[:, axis]) / sizes for axis in range(3)])
    message = f"{len(numbers)} {what}, {len(triangles)} faces"
    return vertices, faces[~unwanted], [Change(kind, message, points, np.zeros(len(points)), taken=triangles)]


def _roundness(vertices: Vertices, faces: Faces, found: Edges, piece: Ints, area: Floats) -> Floats:
    """6 √π V / A^1.5 of each piece, its holes closed by cones."""
    face, side = border_sides(found)
    middle = _middles(vertices[faces].mean(axis=1), piece, len(area))
    # cones over all borders of a piece have one tip: their volumes add up to that of any closing
    a, b, c = (vertices[faces[:, corner]] - middle[piece] for corner in range(3))
    volume = np.bincount(piece, np.einsum("ij,ij->i", a, np.cross(b, c)), minlength=len(area)) / 6.0
    tail, head = vertices[faces[face, side]], vertices[faces[face, (side + 1) % 3]]
    tip = _middles(tail, piece[face], len(area))[piece[face]]
    u, v, w = head - middle[piece[face]], tail - middle[piece[face]], tip - middle[piece[face]]
    volume += np.bincount(piece[face], np.einsum("ij,ij->i", u, np.cross(v, w)), minlength=len(area)) / 6.0
    closed_area = (
        area + np.bincount(piece[face], np.linalg.norm(np.cross(head - tip, tail - tip), axis=1), minlength=len(area)) / 2
    )
    roundness: Floats = 6.0 * np.sqrt(np.pi) * np.abs(volume) / np.maximum(closed_area, 1e-300) ** 1.5
    return roundness


def _middles(points: Floats, piece: Ints, count: int) -> Floats:
    size = np.maximum(np.bincount(piece, minlength=count), 1)
    middle: Floats = np.column_stack([np.bincount(piece, points[:, axis], minlength=count) for axis in range(3)]) / size[:, None]
    return middle
