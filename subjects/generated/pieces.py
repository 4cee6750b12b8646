"""Sets of surfaces in one mesh."""

from __future__ import annotations

import numpy as np

from core.mesh import Mesh


def together(*meshes: Mesh) -> Mesh:
    """Several surfaces as pieces of one mesh."""
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = [mesh.faces + start for mesh, start in zip(meshes, first, strict=False)]
    return Mesh.of(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces))


def moved(mesh: Mesh, x: float, y: float, z: float) -> Mesh:
    """Elsewhere, in mm."""
    return mesh.with_vertices(mesh.vertices + np.array([x, y, z])).rounded_to_float32()


def turned_upright(mesh: Mesh) -> Mesh:
    """Turned about the x axis by 90 degrees."""
    return mesh.with_vertices(mesh.vertices[:, [0, 2, 1]] * (1, -1, 1)).rounded_to_float32()


def inside_out(mesh: Mesh) -> Mesh:
    """Every face turned round."""
    return Mesh.of(mesh.vertices, mesh.faces[:, ::-1])


def opened(mesh: Mesh, faces: int) -> Mesh:
    """The first faces taken out."""
    return Mesh.of(mesh.vertices, mesh.faces[faces:])
