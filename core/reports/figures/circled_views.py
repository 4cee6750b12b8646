"""A surface from all sides with places circled, by kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.patches import Circle
from numpy.typing import NDArray

from core.geometry.body_frame import BodyFrame
from core.mesh import Mesh
from core.reports.figures.canvas import sheet, to_png
from core.reports.figures.standard_views import VIEW_DPI, Panel, arrange_views, place_picture
from core.reports.figures.view import Scratch, Surface, look
from core.reports.palette import Colour, lightened

Floats = NDArray[np.float64]
WIDTH_IN, HEIGHT_IN, LEGEND_IN = 8.4, 5.5, 0.24
RADIUS_PX = 13.0
NUMBER_PX = 16.0  # width of a number beside a circle
CORNERS = ((1, 1), (-1, 1), (1, -1), (-1, -1))  # where the number of a circle stands, by kind: those of two kinds often coincide
SLACK_MM = 10.0  # a place on an inner shell or in a fold counts as visible through this much


@dataclass(frozen=True, eq=False, slots=True)
class Mark:
    """Places of one kind, (N, 3) mm, under one label and colour; `count` says how many there are, if not all are shown."""

    label: str
    colour: str
    count: int
    points: Floats


def draw_circled(
    mesh: Mesh, frame: BodyFrame, colour: Colour, marks: Sequence[Mark], painted: NDArray[np.uint8] | None = None
) -> bytes:
    """Views of a mesh as PNG; a dashed circle is a place on a side that no view shows, a number says how many lie close.

    painted: colours of the faces (F, 3), if they are not all the mesh's own, lightened.
    """
    legend_in = LEGEND_IN * len(marks) + (0.1 if marks else 0.0)
    paint = np.tile(np.array(lightened(colour, 0.62), dtype=np.uint8), (len(mesh.faces), 1)) if painted is None else painted
    surface = Surface.of(mesh)
    with sheet(WIDTH_IN, HEIGHT_IN + legend_in, VIEW_DPI) as figure:
        below_px = round(legend_in * VIEW_DPI)
        panels = arrange_views(mesh, frame, round(WIDTH_IN * VIEW_DPI), round(HEIGHT_IN * VIEW_DPI))
        scratch, seen = Scratch(), []
        for panel in panels:
            raster = look(surface, panel.view, scratch)
            place_picture(figure, panel, raster.paint(paint), below_px)
            seen.append([raster.sees(mark.points, SLACK_MM) for mark in marks])
        for number, mark in enumerate(marks):
            for circle in _circles(mark, panels, np.array([visible[number] for visible in seen])):
                _draw_circle(figure, circle, mark.colour, below_px, CORNERS[number % len(CORNERS)])
        if marks:
            figure.legend(
                handles=[_handle(mark) for mark in marks], loc="lower left", bbox_to_anchor=(0.02, 0.0), borderaxespad=0.2
            )
        return to_png(figure)


@dataclass(frozen=True, slots=True)
class _Circle:
    """Around one or several places that lie close together in a panel; centre in pixels from its lower left corner."""

    panel: Panel
    centre: Floats
    radius_px: float
    count: int
    hidden: bool


def _circles(mark: Mark, panels: Sequence[Panel], visible: NDArray[np.bool_]) -> list[_Circle]:
    """The circles of one kind; visible: (panels, places); places that no view shows are drawn in the first one."""
    circles = []
    nowhere = ~visible.any(axis=0)
    for number, panel in enumerate(panels):
        hidden_here = nowhere if number == 0 else np.zeros_like(nowhere)
        for shown, hidden in ((visible[number], False), (hidden_here, True)):
            flat = (panel.view.flatten(mark.points[shown]) - panel.view.low) * panel.view.pixels_per_mm
            circles += [_Circle(panel, *_ring(members), len(members), hidden) for members in _clusters(flat)]
    return circles


def _ring(members: Floats) -> tuple[Floats, float]:
    """Centre (2,) and radius of a circle around points (N, 2), in pixels."""
    centre = (members.min(axis=0) + members.max(axis=0)) / 2
    return centre, max(RADIUS_PX, float(np.linalg.norm(members - centre, axis=1).max()) + 0.6 * RADIUS_PX)


def _clusters(points: Floats) -> list[Floats]:
    """Points (N, 2) in groups whose circles do not overlap: each point joins, with all its group, what it touches."""
    groups: list[Floats] = []
    for point in points:
        merged = point[None, :]
        while touched := [group for group in groups if _overlap(group, merged)]:
            groups = [group for group in groups if not _overlap(group, merged)]
            merged = np.concatenate([*touched, merged])
        groups.append(merged)
    return groups


def _overlap(first: Floats, second: Floats) -> bool:
    (one, radius), (other, other_radius) = _ring(first), _ring(second)
    return float(np.linalg.norm(one - other)) < radius + other_radius


def _draw_circle(figure: Sheet, circle: _Circle, colour: str, below_px: int, corner: tuple[int, int]) -> None:
    left, bottom, _, _ = circle.panel.place
    x, y = left + float(circle.centre[0]), bottom + below_px + float(circle.centre[1])
    style = "--" if circle.hidden else "-"
    ring = Circle((x, y), circle.radius_px, transform=None, facecolor="none", edgecolor=colour, linewidth=1.2, linestyle=style)
    figure.add_artist(ring)
    if circle.count > 1:
        width_px, height_px = figure.get_size_inches() * figure.dpi
        across, up = corner
        if not 0 < x + across * (circle.radius_px + NUMBER_PX) < width_px:
            across = -across
        at = ((x + across * 0.75 * circle.radius_px) / width_px, (y + up * 0.75 * circle.radius_px) / height_px)
        beside, above = "left" if across > 0 else "right", "bottom" if up > 0 else "top"
        figure.text(*at, str(circle.count), color=colour, fontsize=6.5, ha=beside, va=above)


def _handle(mark: Mark) -> Line2D:
    more = f" ({len(mark.points)} shown)" if len(mark.points) < mark.count else ""
    label = f"{mark.label} × {mark.count}{more}"
    return Line2D([], [], linestyle="none", marker="o", markerfacecolor="none", markeredgecolor=mark.colour, label=label)
