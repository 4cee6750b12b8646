"""The level-set offset that graphics packages use, at the resolution a full body allows."""

from __future__ import annotations

import igl
import numpy as np
from numpy.typing import NDArray

from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh

Ints = NDArray[np.int64]

HALVINGS = 3
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])


def offset_by_level_set(skin: Mesh, depth_mm: float, voxel_mm: float) -> Mesh:
    """Marching cubes of the signed distance, only in cubes near the level; detail below a voxel and thin parts vanish."""
    tree = FaceTree.of(skin.vertices, skin.faces)
    low = skin.vertices.min(axis=0) - 2 * voxel_mm
    coarse = voxel_mm * 2**HALVINGS
    shape = np.ceil((skin.extents_mm() + 4 * voxel_mm) / coarse).astype(int)
    cells = np.stack(np.meshgrid(*(np.arange(n) for n in shape), indexing="ij"), axis=-1).reshape(-1, 3)
    size = coarse
    for _ in range(HALVINGS):
        distance, _foot, _face = closest_points_in(tree, low + (cells + 0.5) * size)
        near = np.abs(distance - depth_mm) < 0.87 * size  # half a cube's diagonal
        cells = (2 * cells[near][:, None] + CORNERS).reshape(-1, 3)
        size /= 2
    corners, number = np.unique((cells[:, None] + CORNERS).reshape(-1, 3), axis=0, return_inverse=True)
    points = low + corners * size
    distance, _foot, _face = closest_points_in(tree, points)
    inside = igl.fast_winding_number(skin.vertices, skin.faces.astype(np.int64), points) > 0.5
    signed = np.where(inside, distance, -distance)
    vertices, faces, _edges = igl.marching_cubes(signed, points, number.reshape(-1, 8).astype(np.int64), depth_mm)
    volume = np.einsum("fi,fi->f", vertices[faces[:, 0]], np.cross(vertices[faces[:, 1]], vertices[faces[:, 2]])).sum()
    return Mesh.of(vertices, faces if volume > 0 else faces[:, ::-1])
