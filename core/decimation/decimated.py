"""What decimation hands back: the surface, and how far it is from the original, so that a report can draw it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.geometry.deviation import Deviation
from core.mesh import Mesh
from core.schema.finding import Finding

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Decimated:
    """One decimated surface with fields for maps.

    mesh: (V', 3), (F', 3), exact in float32. original: what was decimated, rounded to float32, without unused vertices.
    deviation: both ways, at vertices and in the middles of faces. max_deviation_mm: the largest, sampled more densely within
    the faces of the result. vertex_deviation_mm: (V',) from the result's vertices to the original; original_deviation_mm:
    (V,) the other way. curvature_before_deg, curvature_after_deg: (F,), (F',) the mean angle between the normal of a face
    and those of its neighbours (thesis Ch. 3). changes, findings: for the report.
    """

    mesh: Mesh
    original: Mesh
    deviation: Deviation
    max_deviation_mm: float
    curvature_before_deg: Floats
    curvature_after_deg: Floats
    changes: tuple[dict[str, Any], ...]
    findings: tuple[Finding, ...]

    @property
    def vertex_deviation_mm(self) -> Floats:
        """From each vertex of the result to the original, (V',)."""
        return self.deviation.back.at_vertices

    @property
    def original_deviation_mm(self) -> Floats:
        """From each vertex of the original to the result, (V,)."""
        return self.deviation.forth.at_vertices
