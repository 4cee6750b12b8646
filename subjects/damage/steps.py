"""Surfaces of whole voxels."""

from __future__ import annotations

import igl
import numpy as np

from core.mesh import Mesh
from subjects.generated.voxels import isosurface


def stepped(mesh: Mesh, voxel_mm: float) -> Mesh:
    """The surface between voxels whose middles lie inside of a closed mesh and the others; slopes become steps."""
    middle = (mesh.vertices.min(axis=0) + mesh.vertices.max(axis=0)) / 2
    half = float(mesh.extents_mm().max()) / 2 + 3 * voxel_mm
    faces = mesh.faces.astype(np.int64)

    def inside(points: np.ndarray) -> np.ndarray:
        winding: np.ndarray = igl.fast_winding_number(mesh.vertices, faces, points + middle) > 0.5
        return winding.astype(float) - 0.5

    steps = isosurface(inside, half, voxel_mm)
    return steps.with_vertices(steps.vertices + middle).rounded_to_float32()
