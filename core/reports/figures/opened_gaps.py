"""Before and after: sections through the places where tissues were moved farthest to part them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.section import Plane, cut
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet
from core.reports.figures.figure import Figure
from core.reports.figures.plot import Box, Plot
from core.reports.figures.section_drawing import (
    draw_axes,
    draw_contours,
    draw_legend,
    draw_scale_bar,
    legend_height_in,
    shortened,
)
from core.reports.palette import Colour

Floats = NDArray[np.float64]
MOST_PLACES = 3
WINDOW_SHIFTS = 30.0
SMALLEST_WINDOW_MM, LARGEST_WINDOW_MM = 3.0, 40.0
WIDTH_IN, LEFT_IN, GUTTER_IN, TITLE_IN, TICKS_IN = 8.4, 0.45, 0.45, 0.42, 0.28


@dataclass(frozen=True, eq=False, slots=True)
class _Place:
    """Where a surface was moved: point and way, (3,) mm each."""

    name: str
    point: Floats
    way: Floats

    @property
    def shift_mm(self) -> float:
        return float(np.linalg.norm(self.way))

    @property
    def window_mm(self) -> float:
        return float(np.clip(WINDOW_SHIFTS * self.shift_mm, SMALLEST_WINDOW_MM, LARGEST_WINDOW_MM))

    def plane(self) -> Plane:
        """Along the way, which runs upwards."""
        return Plane.of(self.point, np.roll(np.eye(3), 1, axis=0)[int(np.argmax(np.abs(self.way)))], self.way)


def draw_opened_gaps(before: Mapping[str, Mesh], after: Mapping[str, Mesh], colours: Mapping[str, Colour]) -> Figure | None:
    """One column for each of the farthest moves, before above after; None if nothing moved.

    before, after: surfaces of the same names, vertices of the same numbers, outermost first.
    """
    places = _farthest(before, after)
    if not places:
        return None
    panel_in = (WIDTH_IN - LEFT_IN) / MOST_PLACES - GUTTER_IN
    row_in = TITLE_IN + panel_in + TICKS_IN
    total_in = legend_height_in(len(colours)) + 2 * row_in
    sheet = Sheet(WIDTH_IN, total_in)
    for column, place in enumerate(places):
        left_in = LEFT_IN + column * (panel_in + GUTTER_IN)
        for row, meshes in enumerate((after, before)):
            bottom_in = TICKS_IN + row * row_in
            box = (left_in / WIDTH_IN, bottom_in / total_in, panel_in / WIDTH_IN, panel_in / total_in)
            plot = _draw(sheet, box, place, meshes, colours)
            plot.title(f"{shortened(place.name, 14)}\n{'before' if row else f'after: {place.shift_mm:.3g} mm'}")
    draw_legend(sheet, colours)
    png = sheet.png()
    words = "; ".join(f"{place.name} by {place.shift_mm:.3g} mm at {_point_words(place)} mm" for place in places)
    return Figure(
        "opened_gaps", "Where tissues were parted", f"Sections along the farthest moves, before and after: {words}.", png
    )


def _draw(sheet: Sheet, box: Box, place: _Place, meshes: Mapping[str, Mesh], colours: Mapping[str, Colour]) -> Plot:
    plane, half = place.plane(), 0.5 * place.window_mm
    plot = Plot(sheet, box, (-half, -half), (half, half))
    draw_contours(plot, {name: cut(mesh, plane) for name, mesh in meshes.items()}, colours, 1.3)
    draw_axes(plot, plane, absolute=False, whole=True)
    draw_scale_bar(plot)
    return plot


def _farthest(before: Mapping[str, Mesh], after: Mapping[str, Mesh]) -> list[_Place]:
    """The farthest moves, of different surfaces while there are any, none within the window of another."""
    names, points, ways = [], [], []
    for name, mesh in before.items():
        way = after[name].vertices - mesh.vertices
        moved = np.flatnonzero(way.any(axis=1))
        names += [name] * len(moved)
        points.append(mesh.vertices[moved])
        ways.append(way[moved])
    point, way = np.concatenate(points), np.concatenate(ways)
    farthest_first = np.argsort(-np.linalg.norm(way, axis=1), kind="stable")
    places: list[_Place] = []
    for other_surfaces in (True, False):
        for number in farthest_first:
            if len(places) == MOST_PLACES:
                return places
            seen = other_surfaces and any(place.name == names[number] for place in places)
            if not seen and all(np.linalg.norm(point[number] - place.point) > place.window_mm for place in places):
                places.append(_Place(names[number], point[number], way[number]))
    return places


def _point_words(place: _Place) -> str:
    return "(" + ", ".join(f"{value:.1f}" for value in place.point) + ")"
