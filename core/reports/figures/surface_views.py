"""The surface as it is, from all sides, with every place a finding names circled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from numpy.typing import NDArray

from core.mesh import Mesh
from core.reports.figures.body_frame import BodyFrame
from core.reports.figures.canvas import sheet, to_png
from core.reports.figures.figure import Figure
from core.reports.figures.standard_views import VIEW_DPI, Panel, arrange_views, place_picture
from core.reports.figures.view import Raster, Surface, look
from core.reports.palette import Colour, lightened
from core.schema.finding import Finding, Severity

Floats = NDArray[np.float64]
SEVERITY_COLOURS: dict[Severity, str] = {Severity.ERROR: "#c8102e", Severity.WARNING: "#b86e00", Severity.INFO: "#1f6fb2"}
WIDTH_IN, HEIGHT_IN, LEGEND_IN = 8.4, 5.5, 0.24
RADIUS_PX = 13.0
SLACK_MM = 10.0  # a place on an inner shell or in a fold counts as visible through this much


@dataclass(frozen=True, slots=True)
class _Marks:
    """The places of one finding, (N, 3) mm."""

    finding: Finding
    points: Floats


def draw_surface_views(mesh: Mesh, frame: BodyFrame, colour: Colour, findings: Sequence[Finding]) -> Figure:
    """Views of the outermost mesh; a dashed circle is a place on a side that no view shows."""
    marks = [_Marks(finding, _points(finding)) for finding in findings if finding.places]
    legend_in = LEGEND_IN * len(marks) + (0.1 if marks else 0.0)
    paint = np.tile(np.array(lightened(colour, 0.62), dtype=np.uint8), (len(mesh.faces), 1))
    surface = Surface.of(mesh)
    with sheet(WIDTH_IN, HEIGHT_IN + legend_in, VIEW_DPI) as figure:
        below_px = round(legend_in * VIEW_DPI)
        panels = arrange_views(mesh, frame, round(WIDTH_IN * VIEW_DPI), round(HEIGHT_IN * VIEW_DPI))
        rasters = [look(surface, panel.view) for panel in panels]
        for panel, raster in zip(panels, rasters, strict=True):
            place_picture(figure, panel, raster.paint(paint), below_px)
        for mark in marks:
            for panel, centre, hidden in _circles(mark, panels, rasters):
                left, bottom, _, _ = panel.place
                figure.add_artist(
                    Circle(
                        (left + centre[0], bottom + below_px + centre[1]),
                        RADIUS_PX,
                        transform=None,
                        facecolor="none",
                        edgecolor=SEVERITY_COLOURS[mark.finding.severity],
                        linewidth=1.2,
                        linestyle="--" if hidden else "-",
                    )
                )
        if marks:
            figure.legend(
                handles=[_handle(mark) for mark in marks], loc="lower left", bbox_to_anchor=(0.02, 0.0), borderaxespad=0.2
            )
        png = to_png(figure)
    caption = "The outermost surface."
    if marks:
        caption = "Circles: the places the findings name; dashed where no view shows them."
    return Figure("surface", "Surface and places of the findings" if marks else "Surface", caption, png)


def _points(finding: Finding) -> Floats:
    return np.array([place.point_mm for place in finding.places], dtype=np.float64)


def _circles(mark: _Marks, panels: Sequence[Panel], rasters: Sequence[Raster]) -> list[tuple[Panel, Floats, bool]]:
    """(panel, centre in pixels from its lower left corner, hidden) of the circles; places that would overlap share one."""
    circles = []
    visible = np.array([raster.sees(mark.points, SLACK_MM) for raster in rasters])
    nowhere = ~visible.any(axis=0)
    for number, panel in enumerate(panels):
        hidden_here = nowhere if number == 0 else np.zeros_like(nowhere)
        for shown, hidden in ((visible[number], False), (hidden_here, True)):
            flat = (panel.view.flatten(mark.points[shown]) - panel.view.low) * panel.view.pixels_per_mm
            circles += [(panel, centre, hidden) for centre in _thinned(flat)]
    return circles


def _thinned(centres: Floats) -> list[Floats]:
    """Centres that are at least a radius apart, in order."""
    kept: list[Floats] = []
    for centre in centres:
        if all(np.linalg.norm(centre - other) >= RADIUS_PX for other in kept):
            kept.append(centre)
    return kept


def _handle(mark: _Marks) -> Line2D:
    finding = mark.finding
    more = f" ({len(finding.places)} shown)" if len(finding.places) < finding.count else ""
    return Line2D(
        [],
        [],
        linestyle="none",
        marker="o",
        markerfacecolor="none",
        markeredgecolor=SEVERITY_COLOURS[finding.severity],
        label=f"{finding.severity}: {finding.code} × {finding.count}{more}",
    )
