"""Triangle quality before and after: two curves for every surface."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.geometry.quality import quality
from core.mesh import Mesh
from core.reports.figures.canvas import FAINT, Sheet
from core.reports.figures.figure import Figure
from core.reports.figures.legend import Entry, draw_entries
from core.reports.figures.plot import Plot
from core.reports.figures.quality_histogram import SMALLEST_SHARE, TENTHS, dress_shares
from core.reports.figures.section_drawing import shortened
from core.reports.palette import Colour, as_hex

BINS = 50
WIDTH_IN, PANEL_IN, TICKS_IN, LEGEND_IN, TITLE_IN = 8.4, 1.55, 0.45, 0.3, 0.26


def draw_quality_pairs(pairs: Mapping[str, tuple[Mesh, Mesh]], colours: Mapping[str, Colour]) -> Figure:
    """A panel per surface with the share of its faces by q, logarithmic: before thin and grey, after in its colour."""
    total_in = LEGEND_IN + len(pairs) * (TITLE_IN + PANEL_IN) + TICKS_IN
    edges = np.linspace(0.0, 1.0, BINS + 1)
    words = []
    sheet = Sheet(WIDTH_IN, total_in)
    for number, (name, (before, after)) in enumerate(pairs.items()):
        bottom_in = TICKS_IN + (len(pairs) - 1 - number) * (TITLE_IN + PANEL_IN)
        box = (0.10, bottom_in / total_in, 0.88, PANEL_IN / total_in)
        plot = Plot(sheet, box, (0.0, SMALLEST_SHARE), (1.0, 1.0), log_y=True)
        former, present = (quality(mesh.vertices, mesh.faces) for mesh in (before, after))
        plot.steps(edges, _shares(former, edges), FAINT, 1.0)
        plot.steps(edges, _shares(present, edges), as_hex(colours[name]), 1.4)
        dress_shares(plot, "share of faces")
        last = number == len(pairs) - 1
        plot.ticks_x(TENTHS, (lambda part: f"{part:.1f}") if last else None)
        if last:
            plot.label_x("triangle quality q (1: equilateral)")
        plot.title(shortened(name), 3)
        words.append(f"{name} {former.min():.2g} to {present.min():.2g}, mean {former.mean():.3f} to {present.mean():.3f}")
    draw_entries(sheet, (Entry("before", FAINT), Entry("after", "#000000")), 0.09 * sheet.width_px, sheet.height_px, 2)
    png = sheet.png()
    caption = f"Share of faces by quality q = 2 r_in / r_out, logarithmic, before and after. Smallest q: {'; '.join(words)}."
    return Figure("quality_histogram", "Triangle quality before and after", caption, png)


def _shares(q: NDArray[np.float64], edges: NDArray[np.float64]) -> NDArray[np.float64]:
    heights: NDArray[np.float64] = np.maximum(np.histogram(q, bins=edges)[0] / len(q), SMALLEST_SHARE)
    return heights
