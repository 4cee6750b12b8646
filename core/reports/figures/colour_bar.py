"""The scale of colours below a painted surface."""

from __future__ import annotations

import matplotlib
import numpy as np

from core.reports.figures.canvas import INK, Sheet
from core.reports.figures.plot import Box, Plot, round_values

RIM_PT, MARK_PT = 0.4, 1.2
MOST_TICKS = 10


def draw_colour_bar(
    sheet: Sheet,
    box: Box,
    colour_map: str,
    low: float,
    high: float,
    words: str,
    *,
    mark: float | None = None,
    more: bool = False,
) -> None:
    """A bar from low to high with round numbers and words below it; box as `Plot` has it.

    mark: a value with a dark line across. more: values above high have its colour, and the words say so.
    """
    plot = Plot(sheet, box, (low, 0.0), (high, 1.0))
    left, right = round(plot.box.x0), round(plot.box.x1)
    bottom, top = round(plot.box.y0), round(plot.box.y1)
    shades = matplotlib.colormaps[colour_map](np.linspace(0.0, 1.0, right - left), bytes=True)
    sheet.place(np.broadcast_to(shades, (top - bottom, *shades.shape)), left, bottom)
    plot.rim(whole=True, colour=INK, width_pt=RIM_PT)
    values = round_values(low, high, MOST_TICKS)
    plot.ticks_x(values, lambda value: f"{value:g}")
    plot.label_x(f"{words}; above {high:.3g} in the last colour" if more else words)
    if mark is not None:
        plot.upright(mark, INK, MARK_PT)
