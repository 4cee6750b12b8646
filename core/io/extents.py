"""Does the size look like a human? A wrong unit is the most common mistake of an upload; it is told, never corrected."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.io.unit import MM_PER_UNIT, Unit
from core.schema.finding import Finding, Severity

SMALLEST_PART_MM = 20.0  # an ear canal
LARGEST_BODY_MM = 2800.0  # the tallest human measured 2,720 mm
LIKELY_BODY_MM = (900.0, 2300.0)


def check_extents(extents_mm: NDArray[np.float64], unit: Unit, name: str) -> list[Finding]:
    """Warn with `mesh.unit_suspicious` when the longest side (of (3,) mm) suits neither a body nor a part of one."""
    largest = float(extents_mm.max())
    if SMALLEST_PART_MM <= largest <= LARGEST_BODY_MM:
        return []
    raw = largest / MM_PER_UNIT[unit]
    better = suggest_unit(raw)
    hint = (
        f"read as {better} it would be {raw * MM_PER_UNIT[better]:.4g} mm; upload it again as {better} if that was meant"
        if better
        else "no known unit makes it the size of a human"
    )
    message = f"{name} is {largest:.4g} mm long ({raw:.4g} {unit} as given), unlike a human or a part of one: {hint}"
    return [Finding(code="mesh.unit_suspicious", severity=Severity.WARNING, message=message, count=1)]


def suggest_unit(length: float) -> Unit | None:
    """The unit in which `length` is a whole body, else a part of one, else None."""
    for low, high in (LIKELY_BODY_MM, (SMALLEST_PART_MM, LARGEST_BODY_MM)):
        for unit, scale in MM_PER_UNIT.items():
            if low <= length * scale <= high:
                return unit
    return None
