"""Are the triangles good enough to compute with?"""

from __future__ import annotations

import numpy as np

from core.schema.finding import Finding, Severity
from core.validation.places import edge_places, face_places
from core.validation.surface import Surface

LOW_QUALITY = 0.01  # below it a needle's longest side is some hundred times its height: matrices lose digits
SHARP_DEG = 0.1  # tetrahedral meshers stop at sharper folds (TetGen says so itself)


def check_quality(surface: Surface) -> list[Finding]:
    """Warn of faces with quality q below `LOW_QUALITY`, worst first; faces without area have their own finding."""
    q = surface.quality
    low = np.setdiff1d(np.flatnonzero(q < LOW_QUALITY), surface.degenerate)
    if len(low) == 0:
        return []
    worst = low[np.argsort(q[low], kind="stable")]
    message = f"{surface.name} has {len(low)} faces with quality q below {LOW_QUALITY}; the lowest is {q[worst[0]]:.2g}"
    places = face_places(surface.name, surface.mesh, worst)
    return [Finding(code="mesh.quality_low", severity=Severity.WARNING, message=message, count=len(low), places=places)]


def check_dihedral(surface: Surface) -> list[Finding]:
    """Warn of edges whose faces fold onto each other closer than `SHARP_DEG`, sharpest first."""
    edge, pairs, degrees = surface.dihedral
    sharp = np.flatnonzero(degrees < SHARP_DEG)
    if len(sharp) == 0:
        return []
    sharp = sharp[np.argsort(degrees[sharp], kind="stable")]
    message = f"{surface.name} has {len(sharp)} edges folded to less than {SHARP_DEG}°; the sharpest to {degrees[sharp[0]]:.2g}°"
    faces = surface.face_number[pairs[sharp]].tolist()
    places = edge_places(surface.name, surface.mesh, surface.edges.ends[edge[sharp]], faces)
    return [Finding(code="mesh.fold_too_sharp", severity=Severity.WARNING, message=message, count=len(sharp), places=places)]
