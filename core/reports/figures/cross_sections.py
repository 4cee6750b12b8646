"""Cross-sections of all shells at the levels that matter, each with a zoom where the shells come closest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.section import Contour, cut
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet
from core.reports.figures.figure import Figure
from core.reports.figures.levels import Level
from core.reports.figures.plot import Plot
from core.reports.figures.section_drawing import (
    draw_axes,
    draw_contours,
    draw_legend,
    draw_scale_bar,
    legend_height_in,
    mark_window,
)
from core.reports.figures.zoom_window import zoom_window
from core.reports.palette import Colour

Floats = NDArray[np.float64]
SHEET_IN = 8.4
TALLEST_IN = 3.5
TALLEST_ALONE_IN = 2.4
TITLE_WIDTH_IN = 4.1
LEFT_IN, RIGHT_IN, TITLE_IN, TICKS_IN = 0.62, 0.12, 0.30, 0.46


def draw_cross_sections(
    name: str, levels: Sequence[Level], meshes: Mapping[str, Mesh], colours: Mapping[str, Colour]
) -> Figure | None:
    """Each level that meets a mesh: the whole section and a zoom; meshes in nesting order. None if no level does."""
    panels = [panel for panel in (_panel(level, meshes) for level in levels) if any(panel.contours.values())]
    if not panels:
        return None
    lines = _in_lines(panels)
    legend_in = legend_height_in(len(colours))
    total_in = legend_in + sum(TITLE_IN + max(panel.height_in() for panel in line) + TICKS_IN for line in lines)
    sheet = Sheet(SHEET_IN, total_in)
    top_in = total_in - legend_in
    for line in lines:
        bottom_in = top_in - TITLE_IN - max(panel.height_in() for panel in line)
        left_in = 0.0
        for panel in line:
            _draw_panel(sheet, panel, colours, left_in, bottom_in, total_in)
            left_in += panel.width_in()
        top_in = bottom_in - TICKS_IN
    draw_legend(sheet, colours)
    png = sheet.png()
    shown = "; ".join(panel.level.title for panel in panels)
    zoomed = any(panel.zoom is not None for panel in panels)
    caption = f"Exact sections of all surfaces. {shown}."
    return Figure(name, "Cross-sections", caption + (" The frames mark where the shells come closest." if zoomed else ""), png)


@dataclass(frozen=True, slots=True)
class _Panel:
    level: Level
    contours: dict[str, tuple[Contour, ...]]
    zoom: tuple[Floats, Floats] | None

    def aspect(self) -> float:
        """Width over height of the whole section."""
        size = self.level.high - self.level.low
        return float(size[0] / size[1])

    def height_in(self) -> float:
        """So that section and square zoom fill the sheet side by side, within reason."""
        if self.zoom is None:
            return min((SHEET_IN - LEFT_IN - RIGHT_IN) / self.aspect(), TALLEST_ALONE_IN)
        return min((SHEET_IN - 2 * LEFT_IN - RIGHT_IN) / (self.aspect() + 1.0), TALLEST_IN)

    def width_in(self) -> float:
        """With ticks and zoom, and wide enough for its title."""
        drawn = LEFT_IN + self.height_in() * self.aspect() + RIGHT_IN
        return max(drawn, TITLE_WIDTH_IN) if self.zoom is None else SHEET_IN


def _panel(level: Level, meshes: Mapping[str, Mesh]) -> _Panel:
    contours = {mesh: cut(shape, level.plane) for mesh, shape in meshes.items()}
    return _Panel(level, contours, zoom_window(contours, level))


def _in_lines(panels: Sequence[_Panel]) -> list[list[_Panel]]:
    """As many panels side by side as the sheet is wide."""
    lines: list[list[_Panel]] = []
    for panel in panels:
        if lines and sum(other.width_in() for other in lines[-1]) + panel.width_in() <= SHEET_IN:
            lines[-1].append(panel)
        else:
            lines.append([panel])
    return lines


def _draw_panel(
    sheet: Sheet, panel: _Panel, colours: Mapping[str, Colour], left_in: float, bottom_in: float, total_in: float
) -> None:
    level, height_in, width_in = panel.level, panel.height_in(), panel.height_in() * panel.aspect()
    bottom, height = bottom_in / total_in, height_in / total_in
    box = (left_in + LEFT_IN) / SHEET_IN, bottom, width_in / SHEET_IN, height
    whole = Plot(sheet, box, level.low, level.high)
    draw_contours(whole, panel.contours, colours, 0.7)
    draw_axes(whole, level.plane, absolute=level.absolute)
    if not level.absolute:
        whole.label_x("across the hand [mm]")
    draw_scale_bar(whole)
    whole.title(f"{level.title}, seen {level.seen_from}")
    if panel.zoom is not None:
        mark_window(whole, *panel.zoom)
        zoom_left_in = left_in + LEFT_IN + width_in + LEFT_IN
        zoom = Plot(sheet, (zoom_left_in / SHEET_IN, bottom, height_in / SHEET_IN, height), *panel.zoom)
        draw_contours(zoom, panel.contours, colours, 1.3)
        draw_axes(zoom, level.plane, absolute=level.absolute, whole=True)
        draw_scale_bar(zoom)
