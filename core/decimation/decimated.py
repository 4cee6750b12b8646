"""What decimation hands back: the surface, and how far it is from the original, so that a report can draw it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from core.schema.finding import Finding

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Deviation:
    """Distances between original and result over both surfaces, sampled in vertices and inside faces, weighted by area."""

    max_mm: float  # two-sided Hausdorff distance over the samples
    rms_mm: float
    mean_mm: float
    original_to_result_mm: float  # the two one-sided maxima
    result_to_original_mm: float
    samples: int


@dataclass(frozen=True, eq=False, slots=True)
class Decimated:
    """One decimated surface with fields for maps.

    mesh: (V', 3), (F', 3), exact in float32. original: what was decimated, rounded to float32, (V, 3), (F, 3).
    vertex_deviation_mm: (V',) from each vertex of the result to the original. original_deviation_mm: (V,) from each vertex of
    the original to the result. curvature_before_deg, curvature_after_deg: (F,), (F',) mean angle between the normal of a
    face and those of its three neighbours (thesis Ch. 3), of the original and of the result.
    changes, findings: for the report.
    """

    mesh: Mesh
    original: Mesh
    deviation: Deviation
    vertex_deviation_mm: Floats
    original_deviation_mm: Floats
    curvature_before_deg: Floats
    curvature_after_deg: Floats
    changes: tuple[dict[str, Any], ...]
    findings: tuple[Finding, ...]
