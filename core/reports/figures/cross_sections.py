"""Cross-sections of all shells at the levels that matter, each with a zoom where the shells come closest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure as Sheet
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.mesh import Mesh
from core.reports.figures.canvas import sheet, to_png
from core.reports.figures.figure import Figure
from core.reports.figures.levels import Level
from core.reports.figures.section import Contour, cut
from core.reports.figures.section_drawing import draw_contours, draw_legend, draw_scale_bar, frame_zoom, mark_window, set_window
from core.reports.palette import Colour

Floats = NDArray[np.float64]
SHEET_IN = 8.4
ZOOM_SPACINGS = 12.0  # width of the zoom in distances between the outermost and the innermost shell
SMALLEST_ZOOM, LARGEST_ZOOM = 0.06, 0.30  # shares of the window: never smaller; larger shows nothing new
SAMPLES_ACROSS = 800
MOST_SAMPLES = 10_000
MOST_CHAINS = 50  # the longest ones; a broken mesh can have thousands
SMOOTHING = 2.0  # a thin place is a stretch this many spacings to each side, not a single point
TALLEST_IN = 3.5
TALLEST_ALONE_IN = 2.4
LEFT_IN, RIGHT_IN, TITLE_IN, TICKS_IN, LEGEND_IN = 0.62, 0.12, 0.30, 0.46, 0.28


def draw_cross_sections(
    name: str, levels: Sequence[Level], meshes: Mapping[str, Mesh], colours: Mapping[str, Colour]
) -> Figure | None:
    """One row per level that meets a mesh: the whole section and a zoom; meshes in nesting order. None if no level does."""
    rows = [row for row in (_row(level, meshes) for level in levels) if any(row.contours.values())]
    if not rows:
        return None
    total_in = LEGEND_IN + sum(TITLE_IN + row.height_in() + TICKS_IN for row in rows)
    with sheet(SHEET_IN, total_in) as figure:
        top_in = total_in - LEGEND_IN
        for row in rows:
            bottom_in = top_in - TITLE_IN - row.height_in()
            _draw_row(figure, row, colours, bottom_in, total_in)
            top_in = bottom_in - TICKS_IN
        draw_legend(figure, colours)
        png = to_png(figure)
    shown = "; ".join(row.level.title for row in rows)
    zoomed = any(row.zoom is not None for row in rows)
    caption = f"Exact sections of all surfaces. {shown}."
    return Figure(name, "Cross-sections", caption + (" The frames mark where the shells come closest." if zoomed else ""), png)


@dataclass(frozen=True, slots=True)
class _Row:
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


def _row(level: Level, meshes: Mapping[str, Mesh]) -> _Row:
    contours = {mesh: cut(shape, level.plane) for mesh, shape in meshes.items()}
    return _Row(level, contours, _zoom_window(contours, level))


def _draw_row(figure: Sheet, row: _Row, colours: Mapping[str, Colour], bottom_in: float, total_in: float) -> None:
    height_in, width_in = row.height_in(), row.height_in() * row.aspect()
    level = row.level
    bottom, height = bottom_in / total_in, height_in / total_in
    whole = figure.add_axes((LEFT_IN / SHEET_IN, bottom, width_in / SHEET_IN, height))
    draw_contours(whole, row.contours, colours, 0.7)
    set_window(whole, level.plane, level.low, level.high, absolute=level.absolute)
    draw_scale_bar(whole, level.low, level.high)
    whole.set_title(f"{level.title}, seen {level.seen_from}", pad=5)
    if row.zoom is not None:
        mark_window(whole, *row.zoom)
        left_in = LEFT_IN + width_in + LEFT_IN
        zoom = figure.add_axes((left_in / SHEET_IN, bottom, height_in / SHEET_IN, height))
        draw_contours(zoom, row.contours, colours, 1.3)
        set_window(zoom, level.plane, *row.zoom, absolute=level.absolute)
        draw_scale_bar(zoom, *row.zoom)
        frame_zoom(zoom)


def _zoom_window(contours: Mapping[str, Sequence[Contour]], level: Level) -> tuple[Floats, Floats] | None:
    """A square around the stretch where neighbouring shells are closest, measured against their usual distance here;
    None if there is one shell only, or if the whole section is as close up already."""
    sampled = [_resampled(chains, level) for chains in contours.values()]
    sampled = [points for points in sampled if len(points)]
    if len(sampled) < 2:
        return None
    places, ratios, spacings = [], [], []
    for outer, inner in pairwise(sampled):
        distances, _ = cKDTree(outer).query(inner)
        spacing = float(np.median(distances))
        places.append(inner)
        ratios.append(distances / max(spacing, 1e-9))
        spacings.append(spacing)
    window = float((level.high - level.low).max())
    if ZOOM_SPACINGS * sum(spacings) > LARGEST_ZOOM * window:
        return None
    points, ratio = np.concatenate(places), np.concatenate(ratios)
    neighbours = cKDTree(points).query_ball_point(points, SMOOTHING * sum(spacings) + window / SAMPLES_ACROSS)
    smoothed = [float(ratio[near].mean()) for near in neighbours]
    centre = points[int(np.argmin(smoothed))]
    width = max(ZOOM_SPACINGS * sum(spacings), SMALLEST_ZOOM * window)
    half = 0.5 * min(width, float((level.high - level.low).min()))
    centre = np.clip(centre, level.low + half, level.high - half)
    return centre - half, centre + half


def _resampled(chains: Sequence[Contour], level: Level) -> Floats:
    """Points at even distances on the contours, inside the window, (N, 2) mm."""
    spacing = float((level.high - level.low).max()) / SAMPLES_ACROSS
    pieces = [np.empty((0, 2))]
    for chain in chains[:MOST_CHAINS]:
        steps = np.linalg.norm(np.diff(chain.points, axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        places = np.linspace(0.0, along[-1], min(int(along[-1] / spacing) + 1, MOST_SAMPLES))
        pieces.append(np.column_stack([np.interp(places, along, chain.points[:, axis]) for axis in (0, 1)]))
    points = np.concatenate(pieces)
    inside = ((points >= level.low) & (points <= level.high)).all(axis=1)
    kept: Floats = points[inside]
    return kept
