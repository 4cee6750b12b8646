"""What a surface still lacks."""

from __future__ import annotations

from core.mesh import Mesh
from core.schema.finding import Finding
from core.validation.closed import check_closed
from core.validation.faces import check_degenerate_faces, check_duplicate_faces
from core.validation.manifold import check_edge_manifold, check_vertex_manifold
from core.validation.orientation import check_orientation, check_outward
from core.validation.self_intersection import check_self_intersection
from core.validation.surface import Surface
from core.validation.vertices import check_coincident_vertices

NAME = "surface"  # of the one mesh, in places of findings
QUICK = (
    check_degenerate_faces,
    check_duplicate_faces,
    check_coincident_vertices,
    check_edge_manifold,
    check_vertex_manifold,
    check_closed,
    check_orientation,
)


def find_faults(mesh: Mesh) -> tuple[Finding, ...]:
    """Everything that forbids the verdict `simulation_ready`; empty for a fit surface.

    Intersections are looked for, exactly, only in a surface without other faults: they cost most, and which side of a
    piece is out cannot be told before.
    """
    surface = Surface(NAME, mesh)
    found = [finding for check in QUICK for finding in check(surface)]
    if not found:
        found = check_self_intersection(surface)
    if not found:
        found = check_outward(surface)
    return tuple(found)
