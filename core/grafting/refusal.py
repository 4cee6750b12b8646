"""Why a region cannot be grafted, with numbers and places."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.grafting.wall import Box, wall_distance
from core.mesh import Mesh
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.validation.places import point_of

Floats = NDArray[np.float64]


def require_region(name: str, mesh: Mesh, boxes: Sequence[Box]) -> None:
    """Every box must hold some of the mesh, and all of them not the whole. Raises `region.outside_mesh`, `region.covers_mesh`."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    extents = f"the {name} reaches from {words(low)} to {words(high)} mm"
    for number, box in enumerate(boxes):
        if not (wall_distance(mesh.vertices, [box]) < 0.0).any():
            raise InputError(
                "region.outside_mesh",
                f"nothing of the {name} lies in the box from {words(box[0])} to {words(box[1])} mm; {extents}",
                mesh=name,
                region=number,
            )
    if (wall_distance(mesh.vertices, boxes) < 0.0).all():
        raise InputError(
            "region.covers_mesh", f"the region holds the whole {name}, so there is no rim to join; {extents}", mesh=name
        )


def place_finding(code: str, mesh: str, points: Floats | Sequence[Floats], message: str) -> Finding:
    """An error at points (N, 3) mm; the first are kept."""
    places = tuple(Place(mesh=mesh, point_mm=point_of(point)) for point in points[:MAX_PLACES])
    return Finding(code=code, severity=Severity.ERROR, message=message, count=len(points), places=places)


def words(point: Sequence[float] | Floats) -> str:
    """A point in mm for a message."""
    return "(" + ", ".join(f"{float(value):.6g}" for value in point) + ")"
