"""The pictures of the thesis page from finished runs: shells cut open, ears, hand, whole bodies."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from core.geometry.section import Plane
from core.mesh import Mesh
from core.reports.figures.view import View
from core.reports.palette import Colour, as_hex
from scripts.handbook.cut_view import draw_cut

COLOURS: Mapping[str, Colour] = {"skin": (214, 96, 77), "fat": (120, 176, 92), "average_body": (240, 200, 70)}
"""Red, green and yellow as in thesis Fig. 53."""
RIGHT, UP, FRONT = np.eye(3)  # of a picture from the front: the body's left, up, forwards
HAND = (470.0, 170.0, 265.0)


def shells_figure(surfaces: Mapping[str, Mesh]) -> Figure:
    """Figs. 36 and 53: head and hand, a part taken away."""
    figure = Figure(figsize=(9, 4.6), layout="constrained")
    head, hand = figure.subplots(1, 2, width_ratios=(1, 1.05))
    draw_cut(head, surfaces, COLOURS, oblique(30, 12, (0, 700, 20), (260, 290)), Plane.of((8, 0, 0), -FRONT, UP))
    head.set_title("head, left half taken away", fontsize=9)
    draw_cut(hand, surfaces, COLOURS, oblique(35, 50, (462, 165, 265), (105, 100)), Plane.of(HAND, RIGHT, -FRONT))
    hand.set_title("left hand, fingers cut across", fontsize=9)
    add_legend(figure, surfaces)
    return figure


def ears_figure(surfaces: Mapping[str, Mesh]) -> Figure:
    """Figs. 68 and 69: the head with its canals, and the section through both ears."""
    figure = Figure(figsize=(9, 4.4), layout="constrained")
    head, section, ear = figure.subplots(1, 3, width_ratios=(0.8, 1.5, 0.75))
    draw_cut(head, {"skin": surfaces["skin"]}, COLOURS, oblique(66, -4, (75, 712, 45), (52, 78)), None)
    head.set_title("left ear", fontsize=9)
    plane = Plane.of((0, 707, 0), RIGHT, -FRONT)
    draw_cut(section, surfaces, COLOURS, View.of(RIGHT, -FRONT, (-100, -95), (100, 40), 900), plane)
    section.set_title("section at the height of the canals", fontsize=9)
    draw_cut(ear, surfaces, COLOURS, View.of(RIGHT, -FRONT, (64, -72), (90, -34), 900), plane)
    ear.set_title("left ear, larger", fontsize=9)
    add_legend(figure, surfaces)
    return figure


def bodies_figure(surfaces: Mapping[str, Mesh]) -> Figure:
    """Figs. 54 and 70: every surface as a whole."""
    figure = Figure(figsize=(9, 4.6), layout="constrained")
    for axes, (name, mesh) in zip(figure.subplots(1, len(surfaces)), surfaces.items(), strict=True):
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        window = View.of(RIGHT, UP, low[:2] - 20, high[:2] + 20, 800)
        draw_cut(axes, {name: mesh}, COLOURS, window, None)
        axes.set_title(f"{name}: {len(mesh.faces):,} faces", fontsize=9)
    return figure


def oblique(turn_deg: float, tilt_deg: float, centre: tuple[float, float, float], size_mm: tuple[float, float]) -> View:
    """A view from the front, the viewer gone round the body's left by `turn_deg` and up by `tilt_deg`."""
    turn, tilt = np.radians([turn_deg, tilt_deg])
    right = np.cos(turn) * RIGHT - np.sin(turn) * FRONT
    toward = np.cos(tilt) * (np.sin(turn) * RIGHT + np.cos(turn) * FRONT) + np.sin(tilt) * UP
    up = np.cross(toward, right)
    middle = np.array([np.dot(centre, right), np.dot(centre, up)])
    half = np.array(size_mm) / 2
    return View.of(right, up, middle - half, middle + half, 900)


def add_legend(figure: Figure, names: Mapping[str, Mesh]) -> None:
    """The tissues by colour, below."""
    handles = [Patch(facecolor=as_hex(COLOURS[name]), edgecolor="black", linewidth=0.4, label=name) for name in names]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), frameon=False, fontsize=9)


def crossing_windows() -> dict[str, View]:
    """Where Figs. 43 and 44 look: hand, foot, and the head."""
    return {
        "left hand": oblique(35, 30, (465, 165, 255), (140, 150)),
        "left foot": oblique(20, 40, (205, -800, 105), (130, 139)),
        "head": oblique(40, 5, (20, 715, 40), (170, 182)),
    }


def detached_figure(before: Mesh, after: Mesh) -> Figure:
    """Fig. 52: arms grown to the torso, and set apart; above from the front, below cut at the height of the contacts."""
    figure = Figure(figsize=(9, 4.6), layout="constrained")
    grid = figure.subplots(2, 2, height_ratios=(1.35, 1))
    for column, (title, mesh) in enumerate({"before": before, "after": after}.items()):
        draw_cut(grid[0, column], {"skin": mesh}, COLOURS, View.of(RIGHT, UP, (-250, 330), (250, 560), 500), None)
        grid[0, column].set_title(title, fontsize=9)
        plane = Plane.of((0, 420, 0), RIGHT, -FRONT)
        draw_cut(grid[1, column], {"skin": mesh}, COLOURS, View.of(RIGHT, -FRONT, (-250, -120), (250, 70), 500), plane)
    return figure
