"""Numbers of a surface against the one it was made from."""

from __future__ import annotations

import numpy as np

from core.geometry.deviation import Deviation
from core.mesh import Mesh, Vertices
from core.schema.report import ComparisonReport, DeviationNumbers, MeshReport
from core.validation.measure import significant
from core.validation.places import point_of


def compare_with_original(
    original: Mesh, before: MeshReport, result: Mesh, after: MeshReport, deviation: Deviation
) -> ComparisonReport:
    """Numbers for the table of a report; before and after are what was measured of original and result."""
    volumes = (before.volume_mm3, after.volume_mm3)
    return ComparisonReport(
        before=before,
        kept_vertices=count_kept_vertices(original.vertices, result.vertices),
        deviation=DeviationNumbers(
            maximum_mm=significant(deviation.maximum_mm),
            rms_mm=significant(deviation.rms_mm),
            from_original_mm=significant(deviation.forth.maximum_mm),
            to_original_mm=significant(deviation.back.maximum_mm),
            at_mm=point_of(deviation.farthest()),
        ),
        area_change=_share(before.area_mm2, after.area_mm2),
        volume_change=None if volumes[0] is None or volumes[1] is None else _share(volumes[0], volumes[1]),
    )


def count_kept_vertices(original: Vertices, result: Vertices) -> int:
    """Vertices of the result (V', 3) that are among those of the original (V, 3), bit for bit; -0 counts as 0."""
    rows = np.dtype((np.void, 3 * original.itemsize))
    former, present = ((np.ascontiguousarray(vertices) + 0.0).view(rows).ravel() for vertices in (original, result))
    return int(np.isin(present, former).sum())


def _share(before: float, after: float) -> float | None:
    return significant((after - before) / abs(before)) if before else None
