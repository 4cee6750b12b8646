"""One contact opened: a slab of air along its sheet, and smooth skin on both sides of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.detaching.pinholes import count_pinholes, count_tunnels
from core.detaching.round_off import round_off
from core.detaching.sheet import Sheet
from core.detaching.slab import END, FIRST, SECOND, Slab, thicken
from core.detaching.slit_gap import measure_slit
from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.geometry.cut_surface import SKIN, CutSurface
from core.geometry.distance import closest_points_in
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas, face_crosses
from core.geometry.seams import remesh_around_seams
from core.geometry.volume import signed_volumes
from core.mesh import Faces, Mesh

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]
Point = tuple[float, float, float]

SPARE = 1.06  # times the gap asked for: what remeshing may take of it
END_WIDTHS = 1.5  # so far from its end within the body a slit is as wide as was asked
ATTEMPTS = 8
PINHOLE_SHARE = 0.3  # of the width: no ring where the slit comes out of the body is smaller
TOLERANCE_SHARE, TOLERANCE_MM = 0.1, 0.15  # how far remeshing may move the walls: of the gap, and at most
SHRED_SHARE = 1e-4  # of the largest piece's volume: smaller pieces of new faces alone are dropped


@dataclass(frozen=True, eq=False, slots=True)
class Opening:
    """mesh: the skin with the contact open. piece: (F,) SKIN, or FIRST, SECOND, END for the walls of the slit.

    kept: faces, the first ones, that are those before bit for bit. gap_mm, mean_gap_mm: between the two walls.
    area_mm2, middle_mm, normal: of the sheet within the body, the normal towards part 1. end_mm: length of the slit's end
    within the body, 0 if it ends in air all around."""

    mesh: Mesh
    piece: Ints
    kept: int
    gap_mm: float
    mean_gap_mm: float
    area_mm2: float
    middle_mm: Point
    normal: Point
    end_mm: float


def open_contact(skin: Mesh, sheet: Sheet, gap_mm: float, low: Floats, high: Floats) -> Opening | None:
    """The skin with a slit along the sheet, none of the gap missing; None if no attempt was free of self-intersection.

    Promises: only faces with all corners strictly between low and high (3,) mm change; coordinates exact in float32."""
    width, narrow = SPARE * gap_mm, 0.0  # narrow: a width that gave a sound skin, but too small a gap
    for _ in range(ATTEMPTS):
        made = _attempt(skin, sheet, width, gap_mm, low, high)
        if made is not None and made.gap_mm >= gap_mm:
            return made
        if made is not None:
            narrow = width
            width += 1.1 * (gap_mm - made.gap_mm)
        else:
            width = 0.5 * (narrow + width) if narrow else width + 0.02 * gap_mm
    return None


def _attempt(skin: Mesh, sheet: Sheet, width: float, gap_mm: float, low: Floats, high: Floats) -> Opening | None:
    slab = thicken(sheet, width)
    cut = CutSurface.uncut(skin).without(slab.mesh, FIRST)
    if cut is None or not (cut.piece != SKIN).any():
        return None
    inner = within(cut.mesh.vertices, low, high)[cut.mesh.faces].any(axis=1)
    if len(find_intersecting_faces(cut.mesh.vertices, cut.mesh.faces[inner])):
        return None  # a sheet that folds makes a slab that runs through itself within the body
    cut = _without_shreds(_told_apart(cut, slab))
    if not np.isin(cut.mesh.faces[cut.piece == SKIN], cut.mesh.faces[cut.piece != SKIN]).any():
        return None  # the slab came to lie within the body: a cavity opens nothing
    if count_pinholes(cut, PINHOLE_SHARE * width) or count_tunnels(cut, END):
        return None
    remeshed = remesh_around_seams(
        cut,
        skin,
        slab.walls(),
        may_change=np.asarray(within(cut.mesh.vertices, low, high)[cut.mesh.faces].all(axis=1)),
        tolerance_mm=min(TOLERANCE_SHARE * gap_mm, TOLERANCE_MM),
    )
    if remeshed is None:
        return None
    faces = remeshed.mesh.faces
    still = np.union1d(faces[: remeshed.kept], faces[remeshed.piece == END])
    at_wall = np.isin(faces, faces[np.isin(remeshed.piece, (FIRST, SECOND))]).any(axis=1)  # the walls and a ring around them
    free = np.setdiff1d(faces[at_wall], still)
    free = free[within(remeshed.mesh.vertices[free], low, high)]
    rounded = round_off(remeshed.mesh, free, sheet, 0.5 * width)
    if rounded is None:
        return None
    smallest, mean = measure_slit(rounded, remeshed.piece, END_WIDTHS * width)
    area, middle, normal = _within(sheet)
    return Opening(rounded, remeshed.piece, remeshed.kept, smallest, mean, area, middle, normal, _end_length(sheet))


def within(points: Floats, low: Floats, high: Floats) -> Flags:
    """True for points (N, 3) strictly inside of a box."""
    return np.asarray(((points > low) & (points < high)).all(axis=1))


def _told_apart(cut: CutSurface, slab: Slab) -> CutSurface:
    """The walls numbered by the kind of the slab's face they lie on."""
    wall = cut.piece == FIRST
    tree = FaceTree.of(slab.mesh.vertices, slab.mesh.faces)
    _distance, _point, face = closest_points_in(tree, cut.mesh.triangles()[wall].mean(axis=1))
    piece = cut.piece.copy()
    piece[wall] = slab.wall[face]
    return CutSurface(cut.mesh, piece, cut.kept)


def _without_shreds(cut: CutSurface) -> CutSurface:
    """Crumbs that the slab cut off next to the crease are air."""
    count, label = face_components(edges(cut.mesh.faces))
    if count == 1:
        return cut
    volume = signed_volumes(cut.mesh.vertices, cut.mesh.faces, label)
    old = np.zeros(count, dtype=np.bool_)
    old[label[: cut.kept]] = True
    stays = (old | (volume > SHRED_SHARE * volume.max()))[label]
    if stays.all():
        return cut
    used, numbered = np.unique(cut.mesh.faces[stays], return_inverse=True)
    mesh = Mesh.of(cut.mesh.vertices[used], numbered.reshape(-1, 3))
    return CutSurface(mesh, cut.piece[stays], cut.kept)


def _within(sheet: Sheet) -> tuple[float, Point, Point]:
    """Area in mm², middle and unit normal of the sheet inside of the body: each face counts by its corners there."""
    faces: Faces = sheet.faces.astype(np.int32)
    share = sheet.inside[faces].mean(axis=1)
    crosses = 0.5 * share[:, None] * face_crosses(sheet.vertices, faces)
    area = share * face_areas(sheet.vertices, faces)
    middle = area @ sheet.vertices[faces].mean(axis=1) / area.sum()
    return float(area.sum()), _point(middle), _point(crosses.sum(axis=0) / np.linalg.norm(crosses.sum(axis=0)))


def _point(values: Floats) -> Point:
    x, y, z = values.tolist()
    return round(x, 4), round(y, 4), round(z, 4)


def _end_length(sheet: Sheet) -> float:
    net = edges(sheet.faces.astype(np.int32))
    ends = net.ends[(net.face_count == 1)]
    ends = ends[sheet.inside[ends].all(axis=1)]
    return float(np.linalg.norm(sheet.vertices[ends[:, 0]] - sheet.vertices[ends[:, 1]], axis=1).sum())
