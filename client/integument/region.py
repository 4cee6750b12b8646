"""Boxes with their own depths."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

Point = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Region:
    """An axis-aligned box in mm; layer name -> depth in mm inside it, blending to the layers' own across `blend_mm` outside."""

    name: str
    min_mm: Point
    max_mm: Point
    depths_mm: Mapping[str, float]
    blend_mm: float | None = None

    def as_input(self) -> dict[str, Any]:
        """The form the process `shells` takes; without a blend width the server's default holds."""
        region: dict[str, Any] = {
            "name": self.name,
            "box_mm": {"min": list(self.min_mm), "max": list(self.max_mm)},
            "depths_mm": dict(self.depths_mm),
        }
        if self.blend_mm is not None:
            region["blend_mm"] = self.blend_mm
        return region
