"""The ears as they were found and cut: each from its side with its box, and in section with all shells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.body_frame import BodyFrame
from core.geometry.section import Plane
from core.mesh import Mesh
from core.reports.figures.canvas import INK, Sheet, box_path
from core.reports.figures.cross_sections import draw_cross_sections
from core.reports.figures.figure import Figure
from core.reports.figures.levels import Level
from core.reports.figures.standard_views import VIEW_DPI
from core.reports.figures.view import Surface, View, look
from core.reports.palette import Colour, lightened

Floats = NDArray[np.float64]
PANEL_IN, TITLE_IN = 2.8, 0.28
PER_LINE = 3
AROUND, BESIDE = 0.35, 0.2  # of the box's longer side is shown on each side of it, in views and sections
INSIDE: Colour = (226, 155, 0)
WALL: Colour = (24, 128, 178)


@dataclass(frozen=True, eq=False, slots=True)
class EarRegionView:
    """One ear to show: its box (3,), (3,) mm, the box around it and its canals, and where along `up` its section is cut."""

    name: str
    low: Floats
    high: Floats
    with_canal_low: Floats
    with_canal_high: Floats
    section_at_mm: float


def draw_ears(
    surfaces: Mapping[str, Mesh],
    colours: Mapping[str, Colour],
    frame: BodyFrame,
    ears: Sequence[EarRegionView],
    wall: NDArray[np.bool_],
) -> tuple[Figure, ...]:
    """Views and sections of the ears; surfaces in nesting order, one is called skin; wall (F,): faces of the skin in canals."""
    views = _draw_views(surfaces["skin"], colours["skin"], frame, ears, wall)
    levels = [_level(ear, frame) for ear in ears]
    sections = draw_cross_sections("ears_sections", levels, surfaces, colours)
    return (views,) if sections is None else (views, sections)


def _draw_views(skin: Mesh, colour: Colour, frame: BodyFrame, ears: Sequence[EarRegionView], wall: NDArray[np.bool_]) -> Figure:
    centres = skin.triangles().mean(axis=1)
    paint = np.tile(np.array(lightened(colour, 0.62), dtype=np.uint8), (len(skin.faces), 1))
    for ear in ears:
        paint[((centres >= ear.low) & (centres <= ear.high)).all(axis=1)] = lightened(INSIDE, 0.4)
    paint[wall] = lightened(WALL, 0.3)
    surface = Surface.of(skin)
    lines, columns = -(-len(ears) // PER_LINE), min(len(ears), PER_LINE)
    height_in = lines * (PANEL_IN + TITLE_IN)
    sheet = Sheet(columns * PANEL_IN, height_in, VIEW_DPI)
    for number, ear in enumerate(ears):
        left_in, bottom_in = PANEL_IN * (number % PER_LINE), height_in - (number // PER_LINE + 1) * (PANEL_IN + TITLE_IN)
        _draw_panel(sheet, surface, paint, frame, ear, (left_in, bottom_in))
    png = sheet.png()
    caption = "The boxes in which the ears' own depths hold (frames) and the skin inside them."
    return Figure("ears", "Ears", caption + (" Blue: walls of the canals." if wall.any() else ""), png)


def _draw_panel(
    sheet: Sheet,
    surface: Surface,
    paint: NDArray[np.uint8],
    frame: BodyFrame,
    ear: EarRegionView,
    corner_in: tuple[float, float],
) -> None:
    """From the side of the body on which the ear is."""
    side = 1.0 if (ear.low + ear.high - 2 * frame.centre()) @ frame.right >= 0 else -1.0
    right, up = np.cross(frame.up, side * frame.right), frame.up
    flat = np.array([[corner @ right, corner @ up] for corner in (ear.low, ear.high)])
    low, high = flat.min(axis=0), flat.max(axis=0)
    half = (0.5 + AROUND) * float((high - low).max())
    middle = (low + high) / 2
    pixels = round(PANEL_IN * VIEW_DPI)
    view = View.of(right, up, middle - half, middle + half, pixels)
    left_px, bottom_px = (round(inches * VIEW_DPI) for inches in corner_in)
    sheet.place(look(surface, view).paint(paint), left_px, bottom_px)
    corners = (np.array([low, high]) - view.low) * view.pixels_per_mm + (left_px, bottom_px)
    sheet.stroke(box_path(*corners.ravel()), INK, 1.0)
    words = f"{ear.name}, {high[0] - low[0]:.0f} × {high[1] - low[1]:.0f} mm"
    middle_px = (corner_in[0] + 0.5 * PANEL_IN) * VIEW_DPI, (corner_in[1] + PANEL_IN + 0.5 * TITLE_IN) * VIEW_DPI
    sheet.write(*middle_px, words, across="center", up="center")


def _level(ear: EarRegionView, frame: BodyFrame) -> Level:
    plane = Plane.of(frame.up * ear.section_at_mm, frame.right, frame.front)
    flat = plane.flatten(np.array([ear.with_canal_low, ear.with_canal_high]))
    low, high = flat.min(axis=0), flat.max(axis=0)
    margin = BESIDE * float((high - low).max())
    return Level(f"{ear.name}, {ear.section_at_mm:.0f} mm up", "from the feet", plane, low - margin, high + margin)
