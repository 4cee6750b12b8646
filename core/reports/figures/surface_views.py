"""The surface as it is, from all sides, with every place a finding names circled."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.geometry.body_frame import BodyFrame
from core.mesh import Mesh
from core.reports.figures.circled_views import Mark, draw_circled
from core.reports.figures.figure import Figure
from core.reports.palette import Colour
from core.reports.wording import title_of
from core.schema.finding import Finding, Severity

SEVERITY_COLOURS: dict[Severity, str] = {Severity.ERROR: "#c8102e", Severity.WARNING: "#b86e00", Severity.INFO: "#1f6fb2"}


def draw_surface_views(mesh: Mesh, frame: BodyFrame, colour: Colour, findings: Sequence[Finding]) -> Figure:
    """Views of the outermost mesh with the places of the errors and warnings, or else of what is only for information."""
    marks = _marks(findings)
    png = draw_circled(mesh, frame, colour, marks)
    caption = "The outermost surface."
    if marks:
        caption = (
            "Circles: the places the findings name, with their number where several lie close; dashed where no view shows them."
        )
    return Figure("surface", "Surface and places of the findings" if marks else "Surface", caption, png)


def _marks(findings: Sequence[Finding]) -> list[Mark]:
    placed = [finding for finding in findings if finding.places]
    urgent = [finding for finding in placed if finding.severity is not Severity.INFO]
    by_code: dict[tuple[str, Severity], list[Finding]] = {}
    for finding in sorted(urgent or placed, key=lambda each: list(Severity).index(each.severity)):
        by_code.setdefault((finding.code, finding.severity), []).append(finding)
    return [
        Mark(
            f"{severity}: {title_of(code)}",
            SEVERITY_COLOURS[severity],
            sum(finding.count for finding in alike),
            np.array([place.point_mm for finding in alike for place in finding.places], dtype=np.float64),
        )
        for (code, severity), alike in by_code.items()
    ]
