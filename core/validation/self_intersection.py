"""Does the surface run through itself?"""

from __future__ import annotations

from core.schema.counted import counted
from core.schema.finding import MAX_PLACES, Finding, Severity
from core.validation.places import cluster_pairs, cluster_place
from core.validation.surface import Surface


def check_self_intersection(surface: Surface) -> list[Finding]:
    """Report pairs of faces that meet other than in shared corners and edges; one place per cluster, largest first."""
    pairs = surface.intersecting
    if len(pairs) == 0:
        return []
    clusters = cluster_pairs(surface.mesh.faces, pairs)
    message = f"{surface.name} intersects itself: {len(pairs)} pairs of faces, in {counted(len(clusters), 'place')}"
    places = tuple(cluster_place(surface.name, surface.mesh, faces) for faces in clusters[:MAX_PLACES])
    return [Finding(code="mesh.self_intersecting", severity=Severity.ERROR, message=message, count=len(pairs), places=places)]
