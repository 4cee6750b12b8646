"""Is the surface closed?"""

from __future__ import annotations

import numpy as np

from core.geometry.components import label_connected
from core.schema.counted import counted
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.validation.places import point_of
from core.validation.surface import Surface


def check_closed(surface: Surface) -> list[Finding]:
    """Report edges with a single face; one place per hole, largest first, with the vertices of its rim and the faces at it."""
    lone = surface.edges.face_count == 1
    ends = surface.edges.ends[lone]
    if len(ends) == 0:
        return []
    rim, local = np.unique(ends, return_inverse=True)
    holes, label = label_connected(len(rim), *local.reshape(-1, 2).T)
    sizes = np.bincount(label)
    row, side = np.nonzero(lone[surface.edges.of_face])
    hole_of_row = label[np.searchsorted(rim, surface.edges.ends[surface.edges.of_face[row, side], 0])]
    places = []
    for hole in np.argsort(-sizes, kind="stable")[:MAX_PLACES]:
        vertices = rim[label == hole]
        places.append(
            Place(
                mesh=surface.name,
                point_mm=point_of(surface.mesh.vertices[vertices].mean(axis=0)),
                faces=tuple(np.unique(surface.face_number[row[hole_of_row == hole]])[:MAX_PLACES].tolist()),
                vertices=tuple(int(vertex) for vertex in vertices[:MAX_PLACES]),
            )
        )
    message = f"{surface.name} is not closed: {len(ends)} edges have only one face, around {counted(holes, 'hole')}"
    return [Finding(code="mesh.not_closed", severity=Severity.ERROR, message=message, count=len(ends), places=tuple(places))]
