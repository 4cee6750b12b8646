"""Vertices at one place, and vertices of no face."""

from __future__ import annotations

import numpy as np

from core.geometry.coincidence import position_ids
from core.schema.finding import Finding, Severity
from core.validation.places import vertex_places
from core.validation.surface import Surface


def check_coincident_vertices(surface: Surface) -> list[Finding]:
    """Report vertices of faces that lie exactly where another one lies.

    They are cracks (two rims side by side, not joined) or places where the surface touches itself. An exact
    intersection test takes them for shared corners, and formats without vertex numbers (STL) join them: so it is an error.
    """
    used = np.unique(surface.mesh.faces)
    bad = used[position_ids(surface.mesh.vertices[used]) != np.arange(len(used))]
    if len(bad) == 0:
        return []
    message = f"{surface.name} has {len(bad)} vertices at the same place as another: cracks, or the surface touches itself"
    places = vertex_places(surface.name, surface.mesh, bad)
    return [Finding(code="mesh.coincident_vertices", severity=Severity.ERROR, message=message, count=len(bad), places=places)]


def check_unused_vertices(surface: Surface) -> list[Finding]:
    """Mention vertices that no face uses."""
    used = np.zeros(len(surface.mesh.vertices), dtype=bool)
    used[surface.mesh.faces] = True
    idle = np.flatnonzero(~used)
    if len(idle) == 0:
        return []
    message = f"{surface.name} has {len(idle)} vertices that belong to no face"
    places = vertex_places(surface.name, surface.mesh, idle)
    return [Finding(code="mesh.unused_vertices", severity=Severity.INFO, message=message, count=len(idle), places=places)]
