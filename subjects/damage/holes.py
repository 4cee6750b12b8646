"""Missing parts of a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from subjects.damage.places import Generator, near, rings_around, some_faces, some_vertices

Floats = NDArray[np.float64]


def without_faces(mesh: Mesh, generator: Generator, count: int) -> Mesh:
    """Single faces taken out."""
    return Mesh.of(mesh.vertices, np.delete(mesh.faces, some_faces(mesh, generator, count), axis=0))


def without_rings(mesh: Mesh, generator: Generator, count: int, rings: int) -> Mesh:
    """The faces around some vertices taken out, so many rings of them."""
    gone = rings_around(mesh, some_vertices(mesh, generator, count, rings).tolist(), rings - 1)[mesh.faces].any(axis=1)
    return Mesh.of(mesh.vertices, mesh.faces[~gone])


def without_ball(mesh: Mesh, point: Floats, radius_mm: float, islet_mm: float = 0.0) -> Mesh:
    """The faces that reach into a ball taken out; those within a smaller one stay as an islet."""
    gone = near(mesh, point, radius_mm)[mesh.faces].any(axis=1)
    if islet_mm > 0.0:
        gone &= ~near(mesh, point, islet_mm)[mesh.faces].all(axis=1)
    return Mesh.of(mesh.vertices, mesh.faces[~gone])
