"""Faces that should not be there: without area, or twice."""

from __future__ import annotations

from core.schema.finding import Finding, Severity
from core.validation.places import face_places
from core.validation.surface import Surface


def check_degenerate_faces(surface: Surface) -> list[Finding]:
    """Report faces of exactly zero area: a corner repeated, or three corners in one line."""
    bad = surface.degenerate
    if len(bad) == 0:
        return []
    repeated = len(surface.mesh.faces) - len(surface.face_number)
    message = f"{surface.name} has {len(bad)} faces without area; {repeated} of them repeat a corner"
    places = face_places(surface.name, surface.mesh, bad)
    return [Finding(code="mesh.degenerate_faces", severity=Severity.ERROR, message=message, count=len(bad), places=places)]


def check_duplicate_faces(surface: Surface) -> list[Finding]:
    """Report faces over the same three vertices as an earlier face, whichever way round."""
    bad = surface.duplicates
    if len(bad) == 0:
        return []
    message = f"{surface.name} has {len(bad)} faces over the same three vertices as another face"
    places = face_places(surface.name, surface.mesh, bad)
    return [Finding(code="mesh.duplicate_faces", severity=Severity.ERROR, message=message, count=len(bad), places=places)]
