"""Triangle quality of every mesh as curves over one axis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.geometry.quality import quality
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet
from core.reports.figures.figure import Figure
from core.reports.figures.plot import Plot
from core.reports.figures.section_drawing import draw_legend, legend_height_in
from core.reports.palette import Colour, as_hex

BINS = 50
SMALLEST_SHARE = 1e-6
SHARES_PT = 48.0  # room for `0.0001 %`
TENTHS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
WIDTH_IN, PLOT_IN, TICKS_IN = 8.4, 1.75, 0.45


def draw_quality_histogram(meshes: Mapping[str, Mesh], colours: Mapping[str, Colour]) -> Figure:
    """Share of the faces by q = 2 r_in / r_out, logarithmic, so that a single sliver among 100,000 faces shows."""
    qualities = {name: quality(mesh.vertices, mesh.faces) for name, mesh in meshes.items()}
    png = draw_shares(qualities, colours, "share of faces", "triangle quality q (1: equilateral)")
    worst = "; ".join(f"{name} {q.min():.2g}" for name, q in qualities.items())
    caption = f"Share of faces by quality q = 2 r_in / r_out, logarithmic. Smallest q: {worst}."
    return Figure("quality_histogram", "Triangle quality", caption, png)


def draw_shares(values: Mapping[str, NDArray[np.float64]], colours: Mapping[str, Colour], share: str, value: str) -> bytes:
    """A PNG with a curve per name: shares of its values (N,), all within 0..1, in equal bins; axes called `share` and `value`."""
    edges = np.linspace(0.0, 1.0, BINS + 1)
    total_in = legend_height_in(len(values)) + PLOT_IN + TICKS_IN
    sheet = Sheet(WIDTH_IN, total_in)
    box = (0.10, TICKS_IN / total_in, 0.88, PLOT_IN / total_in)
    plot = Plot(sheet, box, (0.0, SMALLEST_SHARE), (1.0, 1.0), log_y=True)
    for (name, own), width_pt in zip(values.items(), _line_widths(len(values)), strict=True):
        shares = np.histogram(own, bins=edges)[0] / len(own)
        plot.steps(edges, np.maximum(shares, SMALLEST_SHARE), as_hex(colours[name]), width_pt)
    dress_shares(plot, share)
    plot.ticks_x(TENTHS, lambda part: f"{part:.1f}")
    plot.label_x(value)
    draw_legend(sheet, {name: colours[name] for name in values})
    return sheet.png()


def _line_widths(count: int) -> NDArray[np.float64]:
    """In points, the first widest: a curve that lies on another leaves its border to be seen."""
    return np.linspace(2.6, 1.1, count) if count > 1 else np.array([1.3])


def dress_shares(plot: Plot, share: str) -> None:
    """A logarithmic axis of shares, from one in a million to all."""
    plot.rim()
    plot.ticks_y([10.0**power for power in range(-6, 1, 2)], lambda part: f"{100 * part:g} %", grid=True)
    plot.label_y(share, SHARES_PT)
