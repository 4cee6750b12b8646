"""The views a reader expects: a person's front, back and both sides of the head; four sides of anything else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.body_frame import BodyFrame
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet
from core.reports.figures.levels import HEAD_ABOVE, axis_name
from core.reports.figures.view import View

Floats = NDArray[np.float64]
MARGIN = 0.03
VIEW_DPI = 160
HEAD_COLUMN = 0.26  # share of the width
BODY_COLUMN = 0.5  # share of the width, beside two views of the head
TITLE_PX = 29  # free above the shape
SMALLEST_WINDOW_MM = 1e-3


@dataclass(frozen=True, slots=True)
class Panel:
    """A view with its title and its place on the sheet: left, bottom, width, height in pixels."""

    title: str
    view: View
    place: tuple[int, int, int, int]

    def title_at(self) -> tuple[float, float]:
        """Middle of the upper edge of the title, in pixels of the field."""
        left, bottom, width, height = self.place
        return left + 0.5 * width, bottom + height - 0.25 * TITLE_PX


def arrange_views(mesh: Mesh, frame: BodyFrame, width: int, height: int) -> tuple[Panel, ...]:
    """Panels that fill a field of width x height pixels, all in the same scale except the views of the head."""
    if frame.is_person:
        return _person(mesh, frame, width, height)
    names = {axis_name(direction): direction for direction in (frame.front, -frame.front, frame.right, -frame.right)}
    half_width, half_height = width // 2, height // 2
    panels = []
    for number, (name, direction) in enumerate(names.items()):
        place = (half_width * (number % 2), height - half_height * (1 + number // 2), half_width, half_height)
        panels.append(panel_of(f"from {name}", mesh.vertices, direction, frame.up, place))
    return tuple(panels)


def arrange_beside(mesh: Mesh, frame: BodyFrame, width: int, height: int) -> tuple[Panel, ...]:
    """Panels for one of two fields of width x height pixels shown side by side: few views, as large as they can be."""
    if not frame.is_person:
        half = height // 2
        return (
            panel_of(f"from {axis_name(frame.front)}", mesh.vertices, frame.front, frame.up, (0, height - half, width, half)),
            panel_of(f"from {axis_name(frame.right)}", mesh.vertices, frame.right, frame.up, (0, 0, width, half)),
        )
    head = mesh.vertices[mesh.vertices @ frame.up > frame.level(HEAD_ABOVE)]
    body_width, half = round(width * BODY_COLUMN), height // 2
    return (
        panel_of("front", mesh.vertices, frame.front, frame.up, (0, 0, body_width, height)),
        panel_of("head, front", head, frame.front, frame.up, (body_width, half, width - body_width, height - half)),
        panel_of("its right side", head, -frame.right, frame.up, (body_width, 0, width - body_width, half)),
    )


def place_picture(sheet: Sheet, panel: Panel, picture: NDArray[np.uint8], below_px: int) -> None:
    """Put a painted view on its place, pixel for pixel, `below_px` above the lower edge of the sheet, with its title."""
    left, bottom, _, _ = panel.place
    sheet.place(picture, left, bottom + below_px)
    across, up = panel.title_at()
    sheet.write(across, up + below_px, panel.title, across="center", up="top")


def _person(mesh: Mesh, frame: BodyFrame, width: int, height: int) -> tuple[Panel, ...]:
    side = min(height // 2, round(width * HEAD_COLUMN))
    body_width = (width - side) // 2
    head = mesh.vertices[mesh.vertices @ frame.up > frame.level(HEAD_ABOVE)]
    half = height // 2
    return (
        panel_of("front", mesh.vertices, frame.front, frame.up, (0, 0, body_width, height)),
        panel_of("back", mesh.vertices, -frame.front, frame.up, (body_width, 0, body_width, height)),
        panel_of("head, its right side", head, -frame.right, frame.up, (2 * body_width, half, side, height - half)),
        panel_of("head, its left side", head, frame.right, frame.up, (2 * body_width, 0, side, half)),
    )


def panel_of(title: str, shown: Floats, toward: Floats, up: Floats, place: tuple[int, int, int, int]) -> Panel:
    """The view from a direction whose window has the shape of its place and holds the points shown."""
    right = np.cross(up, toward)
    flat = np.column_stack([shown @ right, shown @ up])
    low, high = flat.min(axis=0), flat.max(axis=0)
    height_px = place[3]
    pixels = np.array(place[2:], dtype=np.float64)
    free = pixels - (0.0, TITLE_PX)
    mm_per_pixel = max(float(((high - low) / free).max()) * (1 + 2 * MARGIN), SMALLEST_WINDOW_MM / height_px)
    middle = (low + high) / 2 + (0.0, 0.5 * TITLE_PX * mm_per_pixel)
    half = pixels * mm_per_pixel / 2
    return Panel(title, View.of(right, up, middle - half, middle + half, place[3]), place)
