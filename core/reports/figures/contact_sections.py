"""Contacts that were opened, each in section before and after."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.body_frame import BodyFrame
from core.geometry.section import Plane, cut
from core.mesh import Mesh
from core.reports.figures.canvas import Sheet
from core.reports.figures.figure import Figure
from core.reports.figures.plot import Plot
from core.reports.figures.section_drawing import draw_axes, draw_contours, draw_scale_bar
from core.reports.palette import TISSUE_COLOURS

Floats = NDArray[np.float64]
SHEET_IN, PANEL_IN, LEFT_IN, TITLE_IN, TICKS_IN = 8.4, 3.4, 0.62, 0.3, 0.5
MOST_SHOWN = 6
BESIDE = 1.6  # times the radius of a disc of the contact's area is shown on each side of its middle
LEAST_BESIDE_MM = 8.0
UPRIGHT = 0.7  # a contact whose normal points up more than this is cut upright


@dataclass(frozen=True, slots=True)
class ShownContact:
    """Middle (3,) mm, unit normal (3,) and area of a contact."""

    region: str
    middle_mm: tuple[float, float, float]
    normal: tuple[float, float, float]
    area_mm2: float


def draw_contact_sections(before: Mesh, after: Mesh, frame: BodyFrame, contacts: Sequence[ShownContact]) -> Figure:
    """A line for each of the largest contacts: the section through its middle that shows both parts, before and after."""
    shown = sorted(contacts, key=lambda contact: -contact.area_mm2)[:MOST_SHOWN]
    line_in = TITLE_IN + PANEL_IN + TICKS_IN
    total_in = line_in * len(shown)
    sheet = Sheet(SHEET_IN, total_in)
    for number, contact in enumerate(shown):
        plane = _plane(contact, frame)
        middle = plane.flatten(np.array([contact.middle_mm]))[0]
        half = max(BESIDE * float(np.sqrt(contact.area_mm2 / np.pi)), LEAST_BESIDE_MM)
        bottom = (total_in - number * line_in - TITLE_IN - PANEL_IN) / total_in
        for column, (title, mesh) in enumerate((("before", before), ("after", after))):
            left = (LEFT_IN + column * (SHEET_IN / 2)) / SHEET_IN
            box = (left, bottom, PANEL_IN / SHEET_IN, PANEL_IN / total_in)
            plot = Plot(sheet, box, middle - half, middle + half)
            draw_contours(plot, {"skin": cut(mesh, plane)}, TISSUE_COLOURS, 1.0)
            draw_axes(plot, plane)
            draw_scale_bar(plot)
            plot.title(f"{contact.region}, {title}")
    png = sheet.png()
    left_out = f" {len(contacts) - len(shown)} smaller ones are not shown." if len(contacts) > len(shown) else ""
    return Figure("contacts", "Contacts before and after", f"Sections through the middles of the contacts.{left_out}", png)


def _plane(contact: ShownContact, frame: BodyFrame) -> Plane:
    """Across both parts: level, unless they lie one above the other."""
    middle = np.array(contact.middle_mm)
    if abs(float(np.array(contact.normal) @ frame.up)) < UPRIGHT:
        return _grounded(Plane.of(middle, frame.right, frame.front))
    return _grounded(Plane.of(middle, frame.right, frame.up))


def _grounded(plane: Plane) -> Plane:
    """The origin at the foot point, so that coordinates in the plane are those of the mesh."""
    return Plane(plane.normal * (plane.origin @ plane.normal), plane.right, plane.up)
