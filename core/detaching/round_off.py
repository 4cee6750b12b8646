"""New surfaces that go on smoothly into the skin around them, and stay off the sheet."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.detaching.sheet import Sheet
from core.geometry.adjacency import edges, vertex_faces, vertex_neighbours
from core.geometry.distance import closest_points_in
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.laplacian import neighbour_means
from core.geometry.normals import face_normals
from core.geometry.quality import quality
from core.mesh import Faces, Mesh, Vertices

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

ROUNDS = 8
STEP = 0.3  # of the bending of a vertex's surroundings that one round takes away
REPAIRS = 12  # times that vertices at faces that do not fit go back
STEEPEST_TURN = 0.2  # cosine: a face that turns more goes back
LEAST_QUALITY = 0.08  # a face that gets worse than this, and worse than it was, goes back


def round_off(mesh: Mesh, free: Ints, sheet: Sheet, room_mm: float) -> Mesh | None:
    """Let the free vertices (K,) bend as little as they can, room_mm or more off the sheet; exact in float32.

    Promises: other vertices stay; no face near the free ones intersects another, exactly; None if not even the places
    before, pushed off the sheet, are free of that. Source: bilaplacian flow (Kobbelt et al. 1998, doi:10.1145/280814.280831)."""
    tree = FaceTree.of(sheet.vertices, sheet.faces.astype(np.int32))
    neighbours = vertex_neighbours(edges(mesh.faces).ends, len(mesh.vertices))
    ring = np.unique(np.concatenate([free, *(neighbours[int(vertex)].astype(np.int64) for vertex in free)]))
    pushed = _pushed_off(mesh.vertices, free, tree, room_mm)
    places = pushed.copy()
    bend = np.zeros_like(places)
    for _ in range(ROUNDS):
        bend[ring] = neighbour_means(places, neighbours, ring) - places[ring]
        places[free] -= STEP * (neighbour_means(bend, neighbours, free) - bend[free])
        places = _pushed_off(places, free, tree, room_mm)
    touched = np.zeros(len(mesh.vertices), dtype=np.bool_)
    touched[free] = True
    near = np.flatnonzero(touched[mesh.faces].any(axis=1))
    around = vertex_faces(mesh.faces, len(mesh.vertices))
    before, after = (array.astype(np.float32).astype(np.float64) for array in (pushed, places))
    for repair in range(REPAIRS + 1):
        bad = _misfits(mesh, before, after, near)
        if len(bad) == 0:
            return mesh.with_vertices(after)
        if repair == REPAIRS:
            break
        back = np.unique(mesh.faces[bad])
        for _ in range(repair // 3):  # what hangs together goes back together
            back = np.unique(mesh.faces[np.concatenate([around[int(vertex)] for vertex in back])])
        after[back] = before[back]
    still = _crossing(before, mesh.faces, near)
    return None if len(still) else mesh.with_vertices(before)


def _pushed_off(places: Vertices, free: Ints, tree: FaceTree, room_mm: float) -> Vertices:
    distance, nearest, _face = closest_points_in(tree, places[free])
    short = (distance < room_mm) & (distance > 0.1 * room_mm)
    pushed = places.copy()
    away = (places[free[short]] - nearest[short]) / distance[short][:, None]
    pushed[free[short]] = nearest[short] + room_mm * away
    return pushed


def _misfits(mesh: Mesh, before: Vertices, after: Vertices, near: Ints) -> Ints:
    """Faces that turned over, got poor, or cross others."""
    faces = mesh.faces[near]
    old, new = quality(before, faces), quality(after, faces)
    turned = np.einsum("ij,ij->i", face_normals(before, faces), face_normals(after, faces)) < STEEPEST_TURN
    poor = near[turned | ((new < LEAST_QUALITY) & (new < old))]
    crossing = _crossing(after, mesh.faces, near)
    return np.union1d(poor[(before[mesh.faces[poor]] != after[mesh.faces[poor]]).any(axis=(1, 2))], crossing)


def _crossing(vertices: Vertices, faces: Faces, near: Ints) -> Ints:
    """Of the faces near, and those in their box, all that intersect."""
    corners = vertices[faces]
    low, high = corners[near].min(axis=(0, 1)), corners[near].max(axis=(0, 1))
    beside = np.flatnonzero((corners.max(axis=1) >= low).all(axis=1) & (corners.min(axis=1) <= high).all(axis=1))
    return beside[np.unique(find_intersecting_faces(vertices, faces[beside]))]
