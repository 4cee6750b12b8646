"""The surface along which a contact is opened: smooth inside of the body, in the middle of the groove outside of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, gaussian_filter

from core.detaching.border import even_border, trim
from core.detaching.fair_sheet import fair_sheet
from core.detaching.region_grid import RegionGrid
from core.detaching.room import Room
from core.detaching.surface_nets import draw_zero_level
from core.detaching.two_sides import label_faces
from core.geometry.adjacency import edges, vertex_neighbours
from core.geometry.containment import is_inside
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.laplacian import neighbour_means
from core.mesh import Mesh

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

SMOOTHING_CUBES = 1.5  # takes the stairs of the cubes away
ROUNDS = 12  # of evening out the triangles and going back to the middle of the groove
HALFWAY_STEPS = 4
STEP_SHARE = 0.5  # of the edge length: farther no step towards the middle goes
REACH = 1.0  # times the width opened: so far outside of the body the sheet goes on at least
TRIMMINGS = 4


@dataclass(frozen=True, eq=False, slots=True)
class Sheet:
    """vertices (V, 3) mm and faces (F, 3), with border, looking to part 1. inside: (V,) True within the body. side: (S,) 1
    or 2 for the faces of the skin numbered `skin` (S,)."""

    vertices: Floats
    faces: Ints
    inside: Flags
    skin: Ints
    side: NDArray[np.int8]


@dataclass(frozen=True, eq=False, slots=True)
class Sides:
    """The skin of both parts near the contact, and the whole of it."""

    whole: FaceTree
    first: FaceTree
    second: FaceTree

    def halfway(self, points: Floats, longest: float) -> Floats:
        """Points (N, 3) moved to where both parts are equally far."""
        for _ in range(HALFWAY_STEPS):
            to_first, on_first, _face = closest_points_in(self.first, points)
            to_second, on_second, _face = closest_points_in(self.second, points)
            value = to_second - to_first
            slope = (points - on_second) / np.maximum(to_second, 1e-9)[:, None]
            slope -= (points - on_first) / np.maximum(to_first, 1e-9)[:, None]
            steep = np.einsum("ij,ij->i", slope, slope)
            step = -slope * (value / np.maximum(steep, 0.05))[:, None]
            size = np.linalg.norm(step, axis=1)
            points = points + step * np.minimum(1.0, longest / np.maximum(size, 1e-12))[:, None]
        return points

    def off_skin(self, points: Floats) -> Floats:
        """Distance of points (N, 3) to the skin, negative inside; (N,) mm."""
        distance, _point, _face = closest_points_in(self.whole, points)
        signed: Floats = np.where(is_inside(self.whole, points), -distance, distance)
        return signed


def draw_sheet(
    mesh: Mesh, grid: RegionGrid, side: NDArray[np.int8], width_mm: float, edge_mm: float, may_change: Flags, *, halfway: bool
) -> Sheet | None:
    """The sheet between the parts of a cut, trimmed to where it opens something; None if nothing is left of it.

    side: (X, Y, Z) 1, 2, or 0 outside of the body. may_change: (F,) faces of the skin that the opening may touch. halfway: drawn
    to the middle between the parts outside of the body; else it runs there as the cubes are divided, which never folds."""
    towards = _towards_first(side, grid.size_mm)
    points, faces = draw_zero_level(towards, grid.size_mm, edge_mm)
    if len(faces) == 0:
        return None
    points = points + grid.low_mm
    high = grid.high_mm
    corners = mesh.triangles()
    margin = 2 * edge_mm
    near = ((corners.max(axis=1) >= grid.low_mm - margin) & (corners.min(axis=1) <= high + margin)).all(axis=1)
    chosen = np.flatnonzero(near)
    part = label_faces(mesh, chosen, grid, towards)
    if len(np.unique(part)) < 2:
        return None
    sides = Sides(
        FaceTree.of(mesh.vertices, mesh.faces),
        FaceTree.of(mesh.vertices, mesh.faces[chosen[part == 1]]),
        FaceTree.of(mesh.vertices, mesh.faces[chosen[part == 2]]),
    )
    off = sides.off_skin(points)
    faces = faces[(off[faces] < 2.0 * edge_mm + REACH * width_mm).any(axis=1)]
    points, faces = _used(points, faces)
    neighbours = vertex_neighbours(edges(faces.astype(np.int32)).ends, len(points))
    everything = np.arange(len(points))
    for _ in range(ROUNDS):
        points = points + 0.5 * (neighbour_means(points, neighbours, everything) - points)
        if halfway:
            outside = sides.off_skin(points) > 0.0
            points[outside] = sides.halfway(points[outside], STEP_SHARE * edge_mm)
            points = fair_sheet(points, faces, ~outside)
    inside = sides.off_skin(points) < 0.0
    faces = faces[(sides.off_skin(points)[faces] < REACH * width_mm).any(axis=1)]
    if len(faces) == 0:
        return None
    room = Room.of(mesh, may_change, grid.low_mm, high, width_mm)
    for _ in range(TRIMMINGS):
        fits = room.holds(points, faces)
        if fits.all():
            break
        faces = trim(faces[fits], inside)
        if len(faces) == 0:
            return None
        points = even_border(points, faces, inside)
    faces = trim(faces[room.holds(points, faces)], inside)
    if len(faces) == 0:
        return None
    points, faces = _used(points, faces)
    return Sheet(points, faces, sides.off_skin(points) < 0.0, chosen, part)


def _towards_first(side: NDArray[np.int8], size_mm: float) -> Floats:
    """Distance to the border between the parts, positive in part 1, the cubes' stairs smoothed away; (X, Y, Z) mm.

    Air belongs to the part that is nearer."""
    nearest = distance_transform_edt(side == 0, return_distances=False, return_indices=True)
    first = side[tuple(nearest)] == 1
    if first.all() or not first.any():
        return np.where(first, 1.0, -1.0)
    apart = distance_transform_edt(first) - distance_transform_edt(~first)
    apart -= 0.5 * np.sign(apart)
    smoothed: Floats = gaussian_filter(apart, SMOOTHING_CUBES, mode="nearest") * size_mm
    return smoothed


def _used(points: Floats, faces: Ints) -> tuple[Floats, Ints]:
    used, numbered = np.unique(faces, return_inverse=True)
    return points[used], numbered.reshape(-1, 3)
