"""Triangle quality of every mesh as curves over one axis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.ticker import FuncFormatter

from core.geometry.quality import quality
from core.mesh import Mesh
from core.reports.figures.canvas import FAINT, sheet, to_png
from core.reports.figures.figure import Figure
from core.reports.figures.section_drawing import draw_legend, legend_height_in
from core.reports.palette import Colour, as_hex

BINS = 50
SMALLEST_SHARE = 1e-6
WIDTH_IN, PLOT_IN, TICKS_IN = 8.4, 1.75, 0.45


def draw_quality_histogram(meshes: Mapping[str, Mesh], colours: Mapping[str, Colour]) -> Figure:
    """Share of the faces by q = 2 r_in / r_out, logarithmic, so that a single sliver among 100,000 faces shows."""
    edges = np.linspace(0.0, 1.0, BINS + 1)
    total_in = legend_height_in(len(meshes)) + PLOT_IN + TICKS_IN
    with sheet(WIDTH_IN, total_in) as figure:
        axes = figure.add_axes((0.10, TICKS_IN / total_in, 0.88, PLOT_IN / total_in))
        worst = []
        for name, mesh in meshes.items():
            q = quality(mesh.vertices, mesh.faces)
            worst.append(f"{name} {q.min():.2g}")
            shares = np.histogram(q, bins=edges)[0] / len(q)
            heights = np.maximum(np.append(shares, shares[-1]), SMALLEST_SHARE)
            axes.step(edges, heights, where="post", color=as_hex(colours[name]), linewidth=1.3)
        axes.set_yscale("log")
        axes.set_ylim(SMALLEST_SHARE, 1.0)
        axes.set_xlim(0.0, 1.0)
        axes.set_yticks([10.0**power for power in range(-6, 1, 2)])
        axes.minorticks_off()
        axes.yaxis.set_major_formatter(FuncFormatter(lambda share, _position: f"{100 * share:g} %"))
        axes.grid(axis="y", color=FAINT, linewidth=0.3, alpha=0.5)
        axes.set_ylabel("share of faces")
        axes.set_xlabel("triangle quality q (1: equilateral)")
        draw_legend(figure, {name: colours[name] for name in meshes})
        png = to_png(figure)
    caption = f"Share of faces by quality q = 2 r_in / r_out, logarithmic. Smallest q: {'; '.join(worst)}."
    return Figure("quality_histogram", "Triangle quality", caption, png)
