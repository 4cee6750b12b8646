"""Do all faces agree about the outside, and are they right?"""

from __future__ import annotations

import numpy as np

from core.geometry.orientation import find_faces_to_flip
from core.schema.counted import counted
from core.schema.finding import MAX_PLACES, Finding, Severity
from core.validation.places import cluster_place, edge_places
from core.validation.surface import Surface


def check_orientation(surface: Surface) -> list[Finding]:
    """Report edges whose two faces run the same way; places name the edges, the message how many faces to flip."""
    edge, pairs = surface.inconsistent_edges
    if len(edge) == 0:
        return []
    turned = find_faces_to_flip(surface.edges)
    remedy = (
        "the surface is one-sided and cannot be oriented"
        if turned is None
        else f"flipping {counted(len(turned), 'face')} would mend it"
    )
    message = f"{surface.name} is not oriented consistently: at {len(edge)} edges the two faces look opposite ways; {remedy}"
    faces = surface.face_number[pairs].tolist()
    places = edge_places(surface.name, surface.mesh, surface.edges.ends[edge], faces)
    return [Finding(code="mesh.not_oriented", severity=Severity.ERROR, message=message, count=len(edge), places=places)]


def check_outward(surface: Surface) -> list[Finding]:
    """Report pieces that are inside out; cavities have to look into their hollow. One place per piece."""
    wrong = surface.inside_out
    if wrong is None or len(wrong) == 0:
        return []
    cavities = int((surface.component_depths[wrong] % 2).sum())
    pieces = counted(surface.component_count, "piece")
    message = f"{surface.name} is inside out: the faces of {len(wrong)} of {pieces} look the wrong way"
    if cavities:
        message += f"; {cavities} of them are cavities, whose faces have to look into the hollow"
    places = tuple(
        cluster_place(surface.name, surface.mesh, surface.face_number[np.flatnonzero(surface.component == piece)[:1]])
        for piece in wrong[:MAX_PLACES]
    )
    return [Finding(code="mesh.inside_out", severity=Severity.ERROR, message=message, count=len(wrong), places=places)]
