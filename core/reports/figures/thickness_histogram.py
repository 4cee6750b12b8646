"""How much of each layer lies at which depth, with the target as a line and the on-target band around it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import face_areas
from core.mesh import Mesh
from core.reports.figures.canvas import INK, Sheet
from core.reports.figures.figure import Figure
from core.reports.figures.plot import TITLE, Plot, round_values
from core.reports.palette import Colour, as_hex, lightened

Floats = NDArray[np.float64]
BINS = 64
BAND = 0.05  # on target: within 5 % of the target (spec, section 3)
SMALLEST_SHARE = 1e-5
SHARES_PT = 40.0  # room for `0.01 %`
WIDTH_IN, PANEL_IN, MARGIN_IN = 8.4, 1.55, 0.55


def draw_thickness_histogram(
    meshes: Mapping[str, Mesh], depths_mm: Mapping[str, Floats], targets_mm: Mapping[str, float], colours: Mapping[str, Colour]
) -> Figure:
    """One panel per layer; depths (F,) or (V,) of its mesh. Shares are of the layer's area, on a logarithmic scale."""
    total_in = (PANEL_IN + MARGIN_IN) * len(depths_mm)
    sheet = Sheet(WIDTH_IN, total_in)
    for number, (name, depths) in enumerate(depths_mm.items()):
        bottom_in = total_in - number * (PANEL_IN + MARGIN_IN) - PANEL_IN - 0.12
        target = targets_mm[name]
        edges = np.linspace(0.0, max(1.2 * target, float(depths.max()) * 1.001), BINS + 1)
        counts, _ = np.histogram(_per_face(depths, meshes[name]), bins=edges, weights=_area_shares(meshes[name]))
        box = (0.09, bottom_in / total_in, 0.89, (PANEL_IN - 0.14) / total_in)
        plot = Plot(sheet, box, (0.0, SMALLEST_SHARE), (float(edges[-1]), 1.0), log_y=True)
        plot.band((1 - BAND) * target, (1 + BAND) * target, as_hex(lightened((0, 128, 90), 0.8)))
        plot.bars(edges, counts, as_hex(colours[name]))
        plot.upright(target, INK, 1.0)
        plot.words(target, 1.0, f"target {target:.4g} mm", above_pt=2.0, across="center", up="bottom")
        plot.rim()
        plot.ticks_y([1e-4, 1e-3, 1e-2, 1e-1, 1.0], lambda share: f"{100 * share:g} %", grid=True)
        plot.ticks_x(round_values(0.0, float(edges[-1]), 10), lambda depth: f"{depth:g}")
        plot.label_y("share of area", SHARES_PT)
        plot.words(0.01 * float(edges[-1]), 0.2, name, across="left", up="bottom", letters=TITLE)
    plot.label_x("distance to the skin [mm]")
    png = sheet.png()
    caption = (
        "Share of each layer's area by its distance to the skin, logarithmic. Line: the target outside all regions, or its "
        "median if given by vertex; green: within 5 % of it."
    )
    return Figure("thickness_histogram", "Thickness histogram", caption, png)


def _per_face(depths_mm: Floats, mesh: Mesh) -> Floats:
    per_face: Floats = depths_mm if len(depths_mm) == len(mesh.faces) else depths_mm[mesh.faces].mean(axis=1)
    return per_face


def _area_shares(mesh: Mesh) -> Floats:
    areas = face_areas(mesh.vertices, mesh.faces)
    shares: Floats = areas / areas.sum()
    return shares
