"""The creases of a skin, where two parts that grew together meet: the border of a cut between them belongs there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion

from core.detaching.region_grid import RegionGrid
from core.geometry.adjacency import edges
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_crosses, normalised
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FLAT_COST, LEAST_COST = 1.0, 0.02  # of a millimetre of border on a flat skin, and in a sharp valley
SHARP_COST = 0.5  # less than this is a valley that turns by half a radian or more


@dataclass(frozen=True, eq=False, slots=True)
class Creases:
    """The skin of a region as a graph. faces: (N,) of the mesh. pairs: (E, 2) neighbours by their number in `faces`.

    cost_mm: (E,) length of the edge between them, hardly anything in valleys; length_mm, middles: (E,), (E, 3) mm of the edges.
    cubes: (K,) flat numbers of the cubes under the skin, nearest: (K,) the face each lies under, by its number in `faces`."""

    faces: Ints
    pairs: Ints
    cost_mm: Floats
    length_mm: Floats
    middles: Floats
    cubes: Ints
    nearest: Ints

    def sharp_length_mm(self, point: Floats, radius_mm: float) -> float:
        """Length of the sharp valleys within a radius of a point (3,) mm."""
        sharp = self.cost_mm < SHARP_COST * self.length_mm
        near = np.linalg.norm(self.middles - point, axis=1) <= radius_mm
        return float(self.length_mm[sharp & near].sum())


def find_creases(mesh: Mesh, grid: RegionGrid) -> Creases:
    """Of all faces with a part in the box."""
    corners = mesh.triangles()
    met = ((corners.max(axis=1) >= grid.low_mm) & (corners.min(axis=1) <= grid.high_mm)).all(axis=1)
    chosen = np.flatnonzero(met)
    pairs, ends, side = _neighbours(mesh, chosen)
    length = np.linalg.norm(mesh.vertices[ends[:, 1]] - mesh.vertices[ends[:, 0]], axis=1)
    share = valley_shares(mesh, chosen, pairs, ends, side)
    skin = grid.solid & ~binary_erosion(grid.solid, border_value=1)
    cubes = np.flatnonzero(skin)
    places = grid.middles(np.argwhere(skin))
    nearest = closest_points_in(FaceTree.of(mesh.vertices, mesh.faces[chosen]), places)[2] if len(chosen) else cubes[:0]
    return Creases(chosen, pairs, length * share, length, mesh.vertices[ends].mean(axis=1), cubes, nearest)


def _neighbours(mesh: Mesh, chosen: Ints) -> tuple[Ints, Ints, Ints]:
    net = edges(mesh.faces[chosen])
    edge, pair, side = net.two_faces()
    return pair, net.ends[edge].astype(np.int64), side


def valley_shares(mesh: Mesh, chosen: Ints, pairs: Ints, ends: Ints, side: Ints) -> Floats:
    """FLAT_COST for edges (E,) between neighbouring faces that are flat or a ridge, down to LEAST_COST in sharp valleys.

    pairs, side: (E, 2) faces by their number in `chosen`, and which of their sides the edge is; ends: (E, 2) vertices."""
    faces = mesh.faces[chosen]
    normals = normalised(face_crosses(mesh.vertices, faces))
    first, second = normals[pairs[:, 0]], normals[pairs[:, 1]]
    tip = mesh.vertices[faces[pairs[:, 1], (side[:, 1] + 2) % 3]]
    rises = np.einsum("ij,ij->i", tip - mesh.vertices[ends[:, 0]], first) > 0.0  # a valley: the other face stands above
    turn = np.arccos(np.clip(np.einsum("ij,ij->i", first, second), -1.0, 1.0))
    shares: Floats = np.where(rises, np.maximum(FLAT_COST - turn, LEAST_COST), FLAT_COST)
    return shares
