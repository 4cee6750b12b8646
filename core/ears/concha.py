"""The deepest part of the hollow of an ear, where the canal begins."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.ears.find_ears import Ear
from core.errors import InputError
from core.geometry.containment import find_crossings
from core.geometry.face_tree import FaceTree
from core.geometry.normals import vertex_normals
from core.mesh import Mesh

Floats = NDArray[np.float64]

DIRECTIONS = 8
WALL_WITHIN = 0.35  # of the box's height: how far from the floor of the hollow its walls are looked for
FACING_OUT = 0.3
SHALLOWEST_MM = 1.0


def find_concha(skin: Mesh, ear: Ear, up: Floats) -> int:
    """Number of the skin vertex at the floor of the hollow: the one over which the ear rises highest on all sides.

    Raises: InputError `ears.no_concha` if nothing in the box is a hollow a millimetre deep.
    """
    front = np.cross(ear.outward, up)
    inside = np.flatnonzero(ear.holds(skin.vertices))
    points = skin.vertices[inside]
    flat = np.column_stack([points @ front, points @ up])
    heights = points @ ear.outward
    reach = WALL_WITHIN * float(np.abs(ear.high - ear.low) @ np.abs(up))
    facing = vertex_normals(skin.vertices, skin.faces, "area")[inside] @ ear.outward > FACING_OUT
    facing[facing] = ~_is_covered(skin, points[facing], ear.outward)
    best, deepest = -1, SHALLOWEST_MM
    for candidate in np.flatnonzero(facing):
        apart = flat - flat[candidate]
        distance = np.linalg.norm(apart, axis=1)
        near = (distance > 0) & (distance < reach)
        sector = ((np.arctan2(apart[:, 1], apart[:, 0]) / (2 * np.pi) * DIRECTIONS).round().astype(np.int64)) % DIRECTIONS
        rises = np.zeros(DIRECTIONS)
        np.maximum.at(rises, sector[near], heights[near] - heights[candidate])
        if rises.min() > deepest:
            best, deepest = int(inside[candidate]), float(rises.min())
    if best < 0:
        words = ear.name.replace("_", " ")
        raise InputError("ears.no_concha", f"the {words} has no hollow for a canal to begin in; send the canal as a mesh")
    return best


def _is_covered(skin: Mesh, points: Floats, outward: Floats) -> NDArray[np.bool_]:
    """True for points (N, 3) that have skin farther out, as those behind the pinna; (N,)."""
    # the rays of `find_crossings` run towards +x: turn the axes so that this is outwards
    axes = np.roll(np.eye(3), -int(np.argmax(np.abs(outward))), axis=0)
    axes[0] = outward
    low, high = points.min(axis=0), points.max(axis=0)
    corners = skin.triangles()
    far_enough = (corners @ outward).max(axis=1) > (points @ outward).min()
    beside = ((corners.min(axis=1) <= high) & (corners.max(axis=1) >= low)) | (np.abs(outward) > 0)
    faces = skin.faces[beside.all(axis=1) & far_enough]
    point, _face = find_crossings(FaceTree.of(skin.vertices @ axes.T, faces), points @ axes.T)
    covered: NDArray[np.bool_] = np.bincount(point, minlength=len(points)) > 0
    return covered
