"""How many pieces has the surface?"""

from __future__ import annotations

import numpy as np

from core.schema.finding import MAX_PLACES, Finding, Severity
from core.validation.places import face_places
from core.validation.surface import Surface


def check_components(surface: Surface) -> list[Finding]:
    """Mention it if a mesh falls into several pieces, smallest first: often they are dirt or forgotten parts."""
    count = surface.component_count
    if count < 2:
        return []
    sizes = np.bincount(surface.component)
    message = f"{surface.name} falls into {count} pieces of {sizes.min()} to {sizes.max()} faces"
    if surface.closed and (cavities := int((surface.component_depths % 2).sum())):
        message += f"; {cavities} of them are cavities"
    first = surface.face_number[np.unique(surface.component, return_index=True)[1]]
    places = face_places(surface.name, surface.mesh, first[np.argsort(sizes, kind="stable")][:MAX_PLACES])
    return [Finding(code="mesh.several_components", severity=Severity.INFO, message=message, count=count, places=places)]
