"""Contours on axes: tissues filled pale, their surfaces as crisp lines, millimetres on the axes, a scale bar."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.path import Path
from numpy.typing import NDArray

from core.geometry.section import Contour, Plane
from core.reports.figures.canvas import FAINT, INK, Sheet
from core.reports.figures.legend import Entry, draw_entries
from core.reports.figures.levels import axis_of
from core.reports.figures.plot import Plot, round_values
from core.reports.palette import Colour, as_hex, lightened

Floats = NDArray[np.float64]
PALE = 0.72
TICKS = 6
TICKS_PT, DIGIT_PT = 10.0, 5.2  # ticks and gaps, and the width of a digit
LEGEND_LEFT, LEGEND_COLUMNS = 0.05, 4


def draw_contours(plot: Plot, contours: Mapping[str, Sequence[Contour]], colours: Mapping[str, Colour], line_pt: float) -> None:
    """Fill the inside of every mesh, outermost first, then draw the lines on top; open contours are lines only."""
    for order, (name, chains) in enumerate(contours.items()):
        closed = [Path(chain.points, closed=False) for chain in chains if chain.closed]
        if closed:
            plot.fill(Path.make_compound_path(*closed), as_hex(lightened(colours[name], PALE)), order)
    for order, (name, chains) in enumerate(contours.items()):
        if chains:
            lines = Path.make_compound_path(*(Path(chain.points, closed=False) for chain in chains))
            plot.outline(lines, as_hex(colours[name]), line_pt, 100 + order)


def draw_axes(plot: Plot, plane: Plane, *, absolute: bool = True, whole: bool = False) -> None:
    """Ticks in mm of the mesh's own axes (whatever way they run), or relative to the plane's origin and unnamed.

    whole: a dark rim all around, for a zoom like the mark it belongs to."""
    plot.rim(whole=whole, colour=INK if whole else FAINT, width_pt=0.8 if whole else 0.6)
    across, across_sign = axis_of(plane.right) if absolute else ("", 1.0)
    up, up_sign = axis_of(plane.up) if absolute else ("", 1.0)
    plot.ticks_x(round_values(float(plot.low[0]), float(plot.high[0]), TICKS), lambda value: _signed(across_sign * value))
    values = round_values(float(plot.low[1]), float(plot.high[1]), TICKS)
    plot.ticks_y(values, lambda value: _signed(up_sign * value))
    if absolute:
        plot.label_x(f"{across} [mm]")
        longest = max((len(_signed(value)) for value in values), default=1)
        plot.label_y(f"{up} [mm]", TICKS_PT + DIGIT_PT * longest)


def _signed(value: float) -> str:
    return f"{value + 0.0:g}".replace("-", "−")


def draw_scale_bar(plot: Plot) -> None:
    """A bar of a round length, about a fifth of the window, bottom right."""
    width, height = plot.high - plot.low
    length = round_length(float(width) / 5)
    right, bottom = float(plot.high[0] - 0.04 * width), float(plot.low[1] + 0.05 * height)
    bar = Path([(right - length, bottom), (right, bottom)])
    plot.outline(bar, INK, 2.5, 300)
    plot.words(right, bottom, f"{length:g} mm", above_pt=3.0, across="right", up="bottom", ground=True)


def draw_legend(sheet: Sheet, colours: Mapping[str, Colour]) -> None:
    """The meshes by colour along the upper edge of the sheet, `legend_height_in` high."""
    entries = [Entry(shortened(name), as_hex(colour)) for name, colour in colours.items()]
    draw_entries(sheet, entries, LEGEND_LEFT * sheet.width_px, sheet.height_px, LEGEND_COLUMNS)


def legend_height_in(count: int) -> float:
    """Height in inches of a legend of so many names."""
    return 0.12 + 0.17 * math.ceil(count / LEGEND_COLUMNS)


def shortened(name: str, longest: int = 22) -> str:
    """A name that fits its column."""
    return name if len(name) <= longest else name[: longest - 1] + "…"


def mark_window(plot: Plot, low: Floats, high: Floats) -> None:
    """The frame of a zoom on the plot it is taken from."""
    corners = [(low[0], low[1]), (high[0], low[1]), (high[0], high[1]), (low[0], high[1])]
    plot.outline(Path([*corners, corners[0], corners[1]]), INK, 0.8, 290)


def round_length(length_mm: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not longer."""
    power = 10.0 ** np.floor(np.log10(length_mm))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= length_mm * (1 + 1e-9)))
