"""Contours on axes: tissues filled pale, their surfaces as crisp lines, millimetres on the axes, a scale bar."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import NDArray

from core.geometry.section import Contour, Plane
from core.reports.figures.canvas import FAINT, INK, PAPER
from core.reports.figures.levels import axis_of
from core.reports.palette import Colour, as_hex, lightened

Floats = NDArray[np.float64]
PALE = 0.72
LEGEND_COLUMNS = 4


def draw_contours(axes: Axes, contours: Mapping[str, Sequence[Contour]], colours: Mapping[str, Colour], line_pt: float) -> None:
    """Fill the inside of every mesh, outermost first, then draw the lines on top; open contours are lines only."""
    for order, (name, chains) in enumerate(contours.items()):
        closed = [Path(chain.points, closed=False) for chain in chains if chain.closed]
        if closed:
            inside = Path.make_compound_path(*closed)
            axes.add_artist(PathPatch(inside, facecolor=as_hex(lightened(colours[name], PALE)), edgecolor="none", zorder=order))
    for order, (name, chains) in enumerate(contours.items()):
        if chains:
            lines = Path.make_compound_path(*(Path(chain.points, closed=False) for chain in chains))
            style = {"facecolor": "none", "edgecolor": as_hex(colours[name]), "linewidth": line_pt, "joinstyle": "round"}
            axes.add_artist(PathPatch(lines, zorder=100 + order, **style))


def set_window(axes: Axes, plane: Plane, low: Floats, high: Floats, *, absolute: bool = True) -> None:
    """Equal scales, ticks in mm of the mesh's own axes (whatever way they run), or relative to the plane's origin and unnamed."""
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlim(float(low[0]), float(high[0]))
    axes.set_ylim(float(low[1]), float(high[1]))
    for axis, direction in ((axes.xaxis, plane.right), (axes.yaxis, plane.up)):
        letter, sign = axis_of(direction) if absolute else ("", 1.0)
        axis.set_major_locator(MaxNLocator(nbins=6, steps=[1, 2, 5, 10]))
        axis.set_major_formatter(FuncFormatter(lambda value, _position, sign=sign: f"{sign * value + 0.0:g}".replace("-", "−")))
        if absolute:
            axis.set_label_text(f"{letter} [mm]")


def draw_scale_bar(axes: Axes, low: Floats, high: Floats) -> None:
    """A bar of a round length, about a fifth of the window, bottom right."""
    width = float(high[0] - low[0])
    length = round_length(width / 5)
    right, bottom = float(high[0]) - 0.04 * width, float(low[1]) + 0.05 * float(high[1] - low[1])
    axes.plot([right - length, right], [bottom, bottom], color=INK, linewidth=2.5, solid_capstyle="butt", zorder=300)
    axes.annotate(
        f"{length:g} mm",
        (right, bottom),
        (0, 3),
        textcoords="offset points",
        ha="right",
        va="bottom",
        zorder=300,
        bbox={"facecolor": PAPER, "edgecolor": "none", "alpha": 0.75, "pad": 0.8},
    )


def draw_legend(figure: Sheet, colours: Mapping[str, Colour]) -> None:
    """The meshes by colour along the upper edge of the sheet, `legend_height_in` high."""
    handles = [Line2D([], [], color=as_hex(colour), linewidth=2, label=shortened(name)) for name, colour in colours.items()]
    figure.legend(handles=handles, loc="upper left", ncols=LEGEND_COLUMNS, bbox_to_anchor=(0.05, 1.0), borderaxespad=0.4)


def legend_height_in(count: int) -> float:
    """Height in inches of a legend of so many names."""
    return 0.12 + 0.17 * math.ceil(count / LEGEND_COLUMNS)


def shortened(name: str, longest: int = 22) -> str:
    """A name that fits its column."""
    return name if len(name) <= longest else name[: longest - 1] + "…"


def mark_window(axes: Axes, low: Floats, high: Floats) -> None:
    """The frame of a zoom on the axes it is taken from."""
    size = high - low
    axes.add_artist(Rectangle((low[0], low[1]), size[0], size[1], facecolor="none", edgecolor=INK, linewidth=0.8, zorder=290))


def frame_zoom(axes: Axes) -> None:
    """Full frame around a zoom, like the mark it belongs to."""
    for spine in axes.spines.values():
        spine.set_visible(True)
        spine.set_edgecolor(INK)
        spine.set_linewidth(0.8)
    axes.tick_params(color=FAINT)


def round_length(length_mm: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not longer."""
    power = 10.0 ** np.floor(np.log10(length_mm))
    return float(max(step * power for step in (1.0, 2.0, 5.0) if step * power <= length_mm * (1 + 1e-9)))
