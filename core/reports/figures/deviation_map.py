"""How far a surface is from the one it was made from, painted on it."""

from __future__ import annotations

import matplotlib
import numpy as np
from matplotlib.colors import Normalize

from core.geometry.body_frame import BodyFrame
from core.geometry.deviation import Deviation
from core.reports.figures.canvas import Sheet
from core.reports.figures.colour_bar import draw_colour_bar
from core.reports.figures.figure import Figure
from core.reports.figures.standard_views import VIEW_DPI, arrange_views, place_picture
from core.reports.figures.view import Scratch, Surface, look

COLOUR_MAP = "YlOrRd"
WIDTH_IN, HEIGHT_IN, BAR_IN = 8.4, 5.5, 0.66
TOP_PERCENTILE = 99.5
PALEST = 0.04  # of the colour map: white would not show where the surface ends
UNCHANGED_MM = 1e-9  # distances of a surface to itself are not exactly 0


def draw_deviation_map(name: str, deviation: Deviation, frame: BodyFrame) -> Figure:
    """The result, face by face in the colour of its distance to the original."""
    way = deviation.back
    per_face = way.per_face()
    moved = per_face[per_face > UNCHANGED_MM]  # where little was mended, the rest must not set the scale
    top = float(np.percentile(moved, TOP_PERCENTILE)) if len(moved) else UNCHANGED_MM
    scale = Normalize(0.0, top)
    colour_map = matplotlib.colormaps[COLOUR_MAP]
    shades = PALEST + (1.0 - PALEST) * np.clip(scale(per_face), 0.0, 1.0)
    colours = np.ascontiguousarray(colour_map(shades, bytes=True)[:, :3])
    surface, scratch = Surface.of(way.surface), Scratch()
    sheet = Sheet(WIDTH_IN, HEIGHT_IN + BAR_IN, VIEW_DPI)
    for panel in arrange_views(way.surface, frame, round(WIDTH_IN * VIEW_DPI), round(HEIGHT_IN * VIEW_DPI)):
        place_picture(sheet, panel, look(surface, panel.view, scratch).paint(colours), round(BAR_IN * VIEW_DPI))
    box = (0.2, 0.42 / (HEIGHT_IN + BAR_IN), 0.6, 0.13 / (HEIGHT_IN + BAR_IN))
    words = f"distance of {name} to the original [mm]"
    draw_colour_bar(sheet, box, COLOUR_MAP, 0.0, top, words, more=True)
    png = sheet.png()
    x, y, z = deviation.farthest()
    caption = (
        f"Distance of {name} to the surface it was made from. Largest, both ways: {deviation.maximum_mm:.3g} mm at "
        f"({x:.1f}, {y:.1f}, {z:.1f}) mm; root mean square {deviation.rms_mm:.2g} mm."
    )
    return Figure(f"deviation_{name}", f"Deviation map: {name}", caption, png)
