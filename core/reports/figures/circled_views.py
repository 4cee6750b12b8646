"""A surface from all sides with places circled, by kind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.body_frame import BodyFrame
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet, circle_path
from core.reports.figures.legend import Entry, draw_entries, entries_height_px
from core.reports.figures.lettering import Letters
from core.reports.figures.standard_views import VIEW_DPI, Panel, arrange_views, place_picture
from core.reports.figures.view import Scratch, Surface, look
from core.reports.palette import Colour, lightened

Floats = NDArray[np.float64]
WIDTH_IN, HEIGHT_IN, LEGEND_IN = 8.4, 5.5, 0.24
LEGEND_LEFT = 0.02  # of the width
RADIUS_PX, RING_PT = 13.0, 1.2
NUMBER = Letters(6.5)
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
    sheet = Sheet(WIDTH_IN, HEIGHT_IN + legend_in, VIEW_DPI)
    below_px = round(legend_in * VIEW_DPI)
    panels = arrange_views(mesh, frame, round(WIDTH_IN * VIEW_DPI), round(HEIGHT_IN * VIEW_DPI))
    scratch, seen = Scratch(), []
    for panel in panels:
        raster = look(surface, panel.view, scratch)
        place_picture(sheet, panel, raster.paint(paint), below_px)
        seen.append([raster.sees(mark.points, SLACK_MM) for mark in marks])
    for number, mark in enumerate(marks):
        for circle in _circles(mark, panels, np.array([visible[number] for visible in seen])):
            _draw_circle(sheet, circle, mark.colour, below_px, CORNERS[number % len(CORNERS)])
    if marks:
        draw_entries(sheet, [_entry(mark) for mark in marks], LEGEND_LEFT * sheet.width_px, entries_height_px(sheet, len(marks)))
    return sheet.png()


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


def _draw_circle(sheet: Sheet, circle: _Circle, colour: str, below_px: int, corner: tuple[int, int]) -> None:
    left, bottom, _, _ = circle.panel.place
    x, y = left + float(circle.centre[0]), bottom + below_px + float(circle.centre[1])
    sheet.stroke(circle_path(x, y, circle.radius_px), colour, RING_PT, dashed=circle.hidden)
    if circle.count > 1:
        across, up = corner
        if not 0 < x + across * (circle.radius_px + NUMBER_PX) < sheet.width_px:
            across = -across
        sheet.write(
            x + across * 0.75 * circle.radius_px,
            y + up * 0.75 * circle.radius_px,
            str(circle.count),
            across="left" if across > 0 else "right",
            up="bottom" if up > 0 else "top",
            letters=NUMBER,
            colour=colour,
        )


def _entry(mark: Mark) -> Entry:
    more = f" ({len(mark.points)} shown)" if len(mark.points) < mark.count else ""
    return Entry(f"{mark.label} × {mark.count}{more}", mark.colour, "ring")
