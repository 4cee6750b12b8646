"""The places where two surfaces come closest, cut open along the gap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import face_normals
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
from core.schema.report import PairReport

Floats = NDArray[np.float64]
MOST_PLACES = 3
WINDOW_GAPS = 40.0
SMALLEST_WINDOW_MM, LARGEST_WINDOW_MM = 2.0, 40.0
FEW_NAMES, NARROWEST_IN = 2, 4.4  # two names of a legend lie beside each other on a sheet that narrow
WIDTH_IN, LEFT_IN, GUTTER_IN, TITLE_IN, TICKS_IN = 8.4, 0.45, 0.45, 0.42, 0.28


def draw_gap_places(pairs: Sequence[PairReport], meshes: Mapping[str, Mesh], colours: Mapping[str, Colour]) -> Figure | None:
    """The narrowest pairs side by side; None if no pair has a place."""
    placed = [pair for pair in pairs if pair.min_gap_point_mm is not None and pair.min_gap_mm is not None]
    shown = sorted((pair for pair in placed if {pair.a, pair.b} <= set(meshes)), key=lambda pair: pair.min_gap_mm or 0.0)
    shown = shown[:MOST_PLACES]
    if not shown:
        return None
    panel_in = (WIDTH_IN - LEFT_IN) / MOST_PLACES - GUTTER_IN
    width_in = WIDTH_IN if len(colours) > FEW_NAMES else max(NARROWEST_IN, LEFT_IN + len(shown) * (panel_in + GUTTER_IN))
    total_in = legend_height_in(len(colours)) + TITLE_IN + panel_in + TICKS_IN
    sheet = Sheet(width_in, total_in)
    for number, pair in enumerate(shown):
        left_in = LEFT_IN + number * (panel_in + GUTTER_IN)
        box = (left_in / width_in, TICKS_IN / total_in, panel_in / width_in, panel_in / total_in)
        _draw_place(sheet, box, pair, meshes, colours)
    draw_legend(sheet, colours)
    png = sheet.png()
    places = "; ".join(f"{pair.a} and {pair.b}: {_gap_words(pair)}, at {_point_words(pair)} mm" for pair in shown)
    return Figure("gap_places", "Narrowest gaps", f"Sections through the narrowest places: {places}.", png)


def _draw_place(sheet: Sheet, box: Box, pair: PairReport, meshes: Mapping[str, Mesh], colours: Mapping[str, Colour]) -> None:
    point = np.array(pair.min_gap_point_mm, dtype=np.float64)
    across = _nearest_normal(meshes[pair.a], point)
    plane = Plane.of(point, np.roll(np.eye(3), 1, axis=0)[int(np.argmax(np.abs(across)))], across)
    half = 0.5 * float(np.clip(WINDOW_GAPS * (pair.min_gap_mm or 0.0), SMALLEST_WINDOW_MM, LARGEST_WINDOW_MM))
    plot = Plot(sheet, box, (-half, -half), (half, half))
    draw_contours(plot, {name: cut(mesh, plane) for name, mesh in meshes.items()}, colours, 1.3)
    draw_axes(plot, plane, absolute=False, whole=True)
    draw_scale_bar(plot)
    plot.title(f"{shortened(pair.a, 14)} – {shortened(pair.b, 14)}\n{_gap_words(pair)}")


def _nearest_normal(mesh: Mesh, point: Floats) -> Floats:
    """Normal of the face whose centre is nearest, (3,); the plane only has to run across the surface there."""
    centres = mesh.vertices[mesh.faces].mean(axis=1)
    nearest = int(np.argmin(((centres - point) ** 2).sum(axis=1)))
    normal: Floats = face_normals(mesh.vertices, mesh.faces[nearest : nearest + 1])[0]
    return normal if normal.any() else np.array([0.0, 0.0, 1.0])


def _gap_words(pair: PairReport) -> str:
    return "they meet" if not pair.min_gap_mm else f"{pair.min_gap_mm:.3g} mm apart"


def _point_words(pair: PairReport) -> str:
    return "(" + ", ".join(f"{value:.1f}" for value in pair.min_gap_point_mm or ()) + ")"
