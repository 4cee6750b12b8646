"""Where the skin was moved, for the report."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.shells.thickness import vertex_areas
from core.shells.thin_places import find_patches
from core.shells.widen_skin import WidenedSkin


def describe_move(widened: WidenedSkin, bound_mm: float) -> tuple[tuple[dict[str, Any], ...], tuple[Finding, ...]]:
    """What was changed, and the finding `skin.moved_outwards` with a place per patch, largest first; nothing if nothing moved."""
    moved = widened.moved_mm > 0
    if not moved.any():
        return (), ()
    areas = vertex_areas(widened.mesh)
    patches = find_patches(widened.mesh, moved, areas)
    area = float(areas[moved].sum())
    largest = float(widened.moved_mm.max())
    mean = float((areas * widened.moved_mm)[moved].sum() / area)
    share = 100 * area / float(areas.sum())
    change = {
        "mesh": "skin",
        "what": "moved outwards where the body is too thin for the layers inside",
        "bound_mm": bound_mm,
        "largest_mm": round(largest, 6),
        "mean_mm": round(mean, 6),
        "vertices": int(moved.sum()),
        "area_mm2": round(area, 3),
        "places": len(patches),
    }
    worst = [int(patch[np.argmax(widened.moved_mm[patch])]) for patch in patches[:MAX_PLACES]]
    finding = Finding(
        code="skin.moved_outwards",
        severity=Severity.INFO,
        message=f"the skin was moved outwards on {share:.2g} % of its area, in {len(patches)} places, where the body is too thin "
        f"for the layers inside: by {largest:.3g} mm at most and {mean:.3g} mm on average, {bound_mm:g} mm were allowed",
        count=len(patches),
        places=tuple(
            Place(mesh="skin", point_mm=(float(x), float(y), float(z)), vertices=(vertex,))
            for vertex, (x, y, z) in zip(worst, widened.mesh.vertices[worst], strict=True)
        ),
    )
    return (change,), (finding,)
