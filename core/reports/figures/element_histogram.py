"""Shape of the tetrahedra of every tissue as curves over one axis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.reports.figures.figure import Figure
from core.reports.figures.quality_histogram import draw_shares
from core.reports.palette import Colour


def draw_element_histogram(quality: Mapping[str, NDArray[np.float64]], colours: Mapping[str, Colour]) -> Figure:
    """Share of the tetrahedra by quality, logarithmic; quality: tissue -> (T,)."""
    png = draw_shares(quality, colours, "share of tetrahedra", "quality of tetrahedra (1: regular)")
    worst = "; ".join(f"{name} {values.min():.2g}" for name, values in quality.items())
    caption = (
        "Share of the tetrahedra of each tissue by quality, volume over the cube of the root mean square edge, 1 for the "
        f"regular one; logarithmic. Smallest: {worst}."
    )
    return Figure("element_histogram", "Quality of tetrahedra", caption, png)
