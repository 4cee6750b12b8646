"""Depth of one layer painted on it: front, back, and the sides of the head, where the thin ears are."""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from core.geometry.body_frame import BodyFrame
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet
from core.reports.figures.colour_bar import draw_colour_bar
from core.reports.figures.figure import Figure
from core.reports.figures.standard_views import VIEW_DPI, arrange_views, place_picture
from core.reports.figures.view import Scratch, Surface, look

Floats = NDArray[np.float64]
COLOUR_MAP = "magma"
WIDTH_IN, HEIGHT_IN, BAR_IN = 8.4, 5.5, 0.66
TOP_OF_SCALE = 1.1  # of the target: a layer that is too deep shows too


def draw_thickness_map(name: str, mesh: Mesh, depths_mm: Floats, target_mm: float, frame: BodyFrame) -> Figure:
    """One layer's distance to the skin; depths_mm (F,) or (V,)."""
    per_face = depths_mm if len(depths_mm) == len(mesh.faces) else depths_mm[mesh.faces].mean(axis=1)
    low, middle, high = np.percentile(per_face, [1, 50, 99])
    top = max(TOP_OF_SCALE * target_mm, float(high))
    scale = Normalize(0.0, top)
    colour_map = matplotlib.colormaps[COLOUR_MAP]
    colours = np.ascontiguousarray(colour_map(scale(per_face), bytes=True)[:, :3])
    surface, scratch = Surface.of(mesh), Scratch()
    sheet = Sheet(WIDTH_IN, HEIGHT_IN + BAR_IN, VIEW_DPI)
    panels = arrange_views(mesh, frame, round(WIDTH_IN * VIEW_DPI), round(HEIGHT_IN * VIEW_DPI))
    for panel in panels:
        place_picture(sheet, panel, look(surface, panel.view, scratch).paint(colours), round(BAR_IN * VIEW_DPI))
    box = (0.2, 0.42 / (HEIGHT_IN + BAR_IN), 0.6, 0.13 / (HEIGHT_IN + BAR_IN))
    words = f"distance of {name} to the skin [mm]; dark line: target {target_mm:.4g} mm"
    draw_colour_bar(sheet, box, COLOUR_MAP, 0.0, top, words, mark=target_mm)
    png = sheet.png()
    caption = (
        f"Depth of {name}, painted face by face on the layer. Half of the faces are farther from the skin than {middle:.2f} mm, "
        f"99 % farther than {low:.2f} mm; the target outside all regions, or its median if given by vertex: {target_mm:.4g} mm."
    )
    return Figure(f"thickness_{name}", f"Thickness map: {name}", caption, png)
