"""Magnitude of a field painted on a surface from five sides, with the coil beside it."""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.colors import Normalize
from matplotlib.path import Path
from numpy.typing import NDArray

from core.coil import Coil
from core.geometry.body_frame import BodyFrame, find_body_frame
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet
from core.reports.figures.colour_bar import draw_colour_bar
from core.reports.figures.figure import Figure
from core.reports.figures.levels import axis_name
from core.reports.figures.standard_views import VIEW_DPI, Panel, panel_of, place_picture
from core.reports.figures.view import Raster, Scratch, Surface, look

Floats = NDArray[np.float64]
COLOUR_MAP = "viridis"  # as in the 3D view
NO_VALUE = np.array([128, 128, 128], dtype=np.uint8)
WIDTH_IN, HEIGHT_IN, BAR_IN = 8.4, 5.5, 0.66
LONG_TAIL = 1.5  # a maximum that many times the 99th percentile would leave one colour for all the rest
COIL, COIL_BEHIND = "#c8102e", "#e7a1ab"
DOT_PT, STROKE_PT = 1.6, 0.5
STROKE_MM = 5.0  # of the strongest dipole
SLACK_MM = 0.5
MOST_DOTS = 4000  # of a coil of many dipoles every n-th is drawn


def draw_field_map(name: str, surface: Mesh, magnitude: Floats, coil: Coil | None, about: Mesh) -> Figure:
    """magnitude (F,) V/m, NaN is grey. about: the surface whose views are taken, the same for all of a set."""
    known = magnitude[np.isfinite(magnitude)]
    top = _top(known)
    colours = matplotlib.colormaps[COLOUR_MAP](Normalize(0.0, top)(np.nan_to_num(magnitude)), bytes=True)[:, :3]
    paint = np.where(np.isnan(magnitude)[:, None], NO_VALUE, colours).astype(np.uint8)
    seen, scratch = Surface.of(surface), Scratch()
    below_px = round(BAR_IN * VIEW_DPI)
    sheet = Sheet(WIDTH_IN, HEIGHT_IN + BAR_IN, VIEW_DPI)
    shown = about.vertices if coil is None else np.concatenate([about.vertices, coil.places()])
    for panel in _five_sides(shown, find_body_frame(about), round(WIDTH_IN * VIEW_DPI), round(HEIGHT_IN * VIEW_DPI)):
        raster = look(seen, panel.view, scratch)
        place_picture(sheet, panel, raster.paint(np.ascontiguousarray(paint)), below_px)
        if coil is not None:
            _draw_coil(sheet, panel, raster, coil, below_px)
    box = (0.2, 0.42 / (HEIGHT_IN + BAR_IN), 0.6, 0.13 / (HEIGHT_IN + BAR_IN))
    more = len(known) > 0 and float(known.max()) > top
    draw_colour_bar(sheet, box, COLOUR_MAP, 0.0, top, f"magnitude of the field on {name} [V/m]", more=more)
    png = sheet.png()
    return Figure(f"field_{name}", f"Field on {name}", _caption(name, magnitude, known, coil), png)


def _top(known: Floats) -> float:
    """End of the scale: the maximum, or the 99th percentile if few triangles are far above all others."""
    if not len(known):
        return 1.0
    high, highest = float(np.percentile(known, 99)), float(known.max())
    return (high if highest > LONG_TAIL * high > 0.0 else highest) or 1.0


def _five_sides(shown: Floats, frame: BodyFrame, width: int, height: int) -> tuple[Panel, ...]:
    """Front and both sides above, back and top below; of what is no standing person the axes are named."""
    words = ("front", "its right side", "its left side", "back", "top")
    directions = (frame.front, -frame.right, frame.right, -frame.front, frame.up)
    third, half = width // 3, height // 2
    places = (
        *((column * third, height - half, third, half) for column in range(3)),
        *((width // 6 + column * third, 0, third, half) for column in range(2)),
    )
    panels = []
    for word, direction, place in zip(words, directions, places, strict=True):
        up = frame.front if word == "top" else frame.up
        panels.append(panel_of(word if frame.is_person else f"from {axis_name(direction)}", shown, direction, up, place))
    return tuple(panels)


def _draw_coil(sheet: Sheet, panel: Panel, raster: Raster, coil: Coil, below_px: int) -> None:
    """A dot for each dipole or piece of wire with a stroke along it, paler behind the surface."""
    step = max(1, -(-len(coil.places()) // MOST_DOTS))
    places = coil.places()[::step]
    along = np.concatenate([_strokes(coil.moments), coil.wire_along / 2])[::step]
    visible = raster.sees(places, SLACK_MM)
    for shown, colour in ((~visible, COIL_BEHIND), (visible, COIL)):
        starts, ends = (_pixels(panel, points[shown], below_px) for points in (places, places + along))
        if shown.any():
            strokes = Path(np.stack([starts, ends], axis=1).reshape(-1, 2), [Path.MOVETO, Path.LINETO] * len(starts))
            sheet.stroke(strokes, colour, STROKE_PT)
            sheet.dots(starts, DOT_PT, colour)


def _strokes(moments: Floats) -> Floats:
    lengths = np.linalg.norm(moments, axis=1)
    return STROKE_MM / max(float(lengths.max(initial=0.0)), np.finfo(float).tiny) * moments


def _pixels(panel: Panel, points: Floats, below_px: int) -> Floats:
    left, bottom, _, _ = panel.place
    pixels: Floats = (panel.view.flatten(points) - panel.view.low) * panel.view.pixels_per_mm + (left, bottom + below_px)
    return pixels


def _caption(name: str, magnitude: Floats, known: Floats, coil: Coil | None) -> str:
    if not len(known):
        return f"No triangle of {name} is near enough to the field."
    told = f"Magnitude on {name}, triangle by triangle: half of them above {np.median(known):.4g}, at most {known.max():.4g} V/m."
    grey = len(magnitude) - len(known)
    if grey:
        told += f" Grey: {grey} triangles too far from the field."
    return told if coil is None else f"{told} Red: the coil, dot by dipole with its moment, paler where it is behind."
