"""Is the surface manifold: at most two faces at an edge, one fan of faces at a vertex?"""

from __future__ import annotations

import numpy as np

from core.schema.finding import MAX_PLACES, Finding, Severity
from core.validation.places import edge_places, vertex_places
from core.validation.surface import Surface


def check_edge_manifold(surface: Surface) -> list[Finding]:
    """Report edges with more than two faces (thesis Fig. 18 b)."""
    bad = np.flatnonzero(surface.edges.face_count > 2)
    if len(bad) == 0:
        return []
    at_edge = [surface.face_number[(surface.edges.of_face == edge).any(axis=1)].tolist() for edge in bad[:MAX_PLACES]]
    message = f"{surface.name} is not manifold: {len(bad)} edges have more than two faces, up to {surface.edges.face_count.max()}"
    places = edge_places(surface.name, surface.mesh, surface.edges.ends[bad], at_edge)
    return [Finding(code="mesh.edge_not_manifold", severity=Severity.ERROR, message=message, count=len(bad), places=places)]


def check_vertex_manifold(surface: Surface) -> list[Finding]:
    """Report vertices whose faces form several fans (thesis Fig. 18 c); ends of edges with too many faces are not repeated."""
    bad = surface.split_vertices
    if len(bad) == 0:
        return []
    message = f"{surface.name} is not manifold: at {len(bad)} vertices several fans of faces meet in one point"
    places = vertex_places(surface.name, surface.mesh, bad)
    return [Finding(code="mesh.vertex_not_manifold", severity=Severity.ERROR, message=message, count=len(bad), places=places)]
