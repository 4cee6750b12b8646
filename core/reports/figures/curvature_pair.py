"""A surface before and after, painted by its curvature as the thesis measures it (Figs. 24 to 31): flat places are dark."""

from __future__ import annotations

from dataclasses import replace

import matplotlib
import numpy as np
from matplotlib.colors import Normalize
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.body_frame import BodyFrame
from core.geometry.dihedral import dihedral_angles
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet
from core.reports.figures.colour_bar import draw_colour_bar
from core.reports.figures.figure import Figure
from core.reports.figures.lettering import Letters
from core.reports.figures.standard_views import VIEW_DPI, Panel, arrange_beside, place_picture
from core.reports.figures.view import Scratch, Surface, look
from core.reports.wording import whole

Floats = NDArray[np.float64]
COLOUR_MAP = "viridis"
WIDTH_IN, HEIGHT_IN, BAR_IN, HEAD_IN = 8.4, 5.4, 0.66, 0.26
BOLD = Letters(weight="bold")
TOP_PERCENTILE = 98.0  # of the faces after: a single spike must not turn all others dark
SMALLEST_TOP_DEG = 5.0


def face_curvature(mesh: Mesh) -> Floats:
    """Mean angle in degrees between the normal of each face and those of its neighbours, (F,): 0 where flat or without any."""
    _, pair, angle = dihedral_angles(mesh.vertices, mesh.faces, edges(mesh.faces))
    count = np.bincount(pair.ravel(), minlength=len(mesh.faces))
    total = np.bincount(pair.ravel(), np.repeat(180.0 - angle, 2), minlength=len(mesh.faces))
    mean: Floats = total / np.maximum(count, 1)
    return mean


def draw_curvature_pair(name: str, before: Mesh, after: Mesh, frame: BodyFrame) -> Figure:
    """The same views of both, left and right, in one scale of colours."""
    curvatures = face_curvature(before), face_curvature(after)
    top = max(SMALLEST_TOP_DEG, float(np.percentile(curvatures[1], TOP_PERCENTILE)))
    scale = Normalize(0.0, top)
    colour_map = matplotlib.colormaps[COLOUR_MAP]
    half_px = round(WIDTH_IN * VIEW_DPI) // 2
    total_in = HEIGHT_IN + BAR_IN + HEAD_IN
    panels = arrange_beside(before, frame, half_px, round(HEIGHT_IN * VIEW_DPI))
    scratch = Scratch()
    sheet = Sheet(WIDTH_IN, total_in, VIEW_DPI)
    for side, (title, mesh, curvature) in enumerate(zip(("before", "after"), (before, after), curvatures, strict=True)):
        colours = np.ascontiguousarray(colour_map(scale(curvature), bytes=True)[:, :3])
        surface = Surface.of(mesh)
        for panel in panels:
            shifted = _shifted(panel, side * half_px)
            place_picture(sheet, shifted, look(surface, panel.view, scratch).paint(colours), round(BAR_IN * VIEW_DPI))
        words = f"{title}: {whole(len(mesh.faces))} faces"
        middle = (0.25 + 0.5 * side) * sheet.width_px, (1.0 - 0.5 * HEAD_IN / total_in) * sheet.height_px
        sheet.write(*middle, words, across="center", up="center", letters=BOLD)
    box = (0.2, 0.42 / total_in, 0.6, 0.13 / total_in)
    words = "mean angle between the normals of a face and its neighbours [°]"
    draw_colour_bar(sheet, box, COLOUR_MAP, 0.0, top, words, more=True)
    png = sheet.png()
    means = (float(curvature.mean()) for curvature in curvatures)
    caption = (
        f"{name} before and after, every face in the colour of its curvature: the mean angle between its normal and those of its "
        "neighbours, which grows with the size of faces. Mean over all faces: {:.2f}° before, {:.2f}° after.".format(*means)
    )
    return Figure(f"curvature_{name}", f"Curvature before and after: {name}", caption, png)


def _shifted(panel: Panel, right_px: int) -> Panel:
    left, bottom, width, height = panel.place
    return replace(panel, place=(left + right_px, bottom, width, height))
