"""Pieces that run into each other, and what they are together."""

from __future__ import annotations

from collections.abc import Sequence

import manifold3d
import numpy as np

from core.mesh import Mesh
from subjects.damage.places import Floats
from subjects.generated.pieces import moved
from subjects.generated.revolved import ball
from subjects.generated.solid import mesh_of


def balls_at(places: Sequence[Sequence[float] | Floats], radius_mm: float) -> tuple[Mesh, ...]:
    """Balls of 1,280 faces around places in mm."""
    return tuple(moved(ball(radius_mm, 3), *(float(value) for value in place)) for place in places)


def united(*meshes: Mesh) -> Mesh:
    """The union of closed surfaces, each free of self-intersection."""
    solids = [
        manifold3d.Manifold(manifold3d.Mesh(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))) for mesh in meshes
    ]
    return mesh_of(manifold3d.Manifold.batch_boolean(solids, manifold3d.OpType.Add))
