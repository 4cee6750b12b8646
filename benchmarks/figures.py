"""`python -m benchmarks.figures [FOLDER]`: the pictures of docs/algorithms/shells.md, from a run on the body."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from benchmarks.makers import vertex_normal_offset
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.normals import vertex_normals
from core.geometry.section import Plane, cut
from core.mesh import Mesh
from core.shells.nested_shells import REACH_SHARE, Shell, create_shells
from core.shells.reach import measure_reach
from core.shells.thickness import vertex_areas
from subjects.body import body
from subjects.trial import shells_inputs

DEPTHS_MM = (1.0, 3.0)
COLOURS = ("#222222", "#0072b2", "#d55e00")  # Okabe & Ito: told apart without red and green
EAR = (Plane.of((0, 725, 0), (0, 0, 1), (1, 0, 0)), (26, 68, 62, 91))
FINGERS = (Plane.of((0, 150, 0), (1, 0, 0), (0, 0, 1)), (460, 500, 232, 300))
HEAD_FROM_MM = 640.0


def main() -> None:
    """The folder defaults to docs/algorithms."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/algorithms")
    mpl.use("Agg")
    mpl.rcParams.update({"font.size": 8, "axes.titlesize": 8, "svg.hashsalt": "integument"})
    skin = body(1)
    shells = create_shells(skin, shells_inputs(DEPTHS_MM))
    _sections(skin, shells).savefig(folder / "sections.png", dpi=110)
    _before_and_after(skin, shells).savefig(folder / "naive-and-ours.png", dpi=110)
    _depths(skin, shells).savefig(folder / "depth.png", dpi=110)


def _sections(skin: Mesh, shells: Sequence[Shell]) -> Figure:
    figure = Figure(figsize=(8, 3.6), layout="constrained")
    ear, fingers = figure.subplots(1, 2)
    meshes = [skin, *(shell.mesh for shell in shells)]
    _draw_section(ear, meshes, *EAR)
    ear.set_title("ear, horizontal section")
    _draw_section(fingers, meshes, *FINGERS)
    fingers.set_title("fingers, horizontal section")
    return figure


def _before_and_after(skin: Mesh, shells: Sequence[Shell]) -> Figure:
    figure = Figure(figsize=(8, 3.6), layout="constrained")
    axes = figure.subplots(1, 2)
    for axis, inner, name in zip(
        axes,
        (vertex_normal_offset(skin, DEPTHS_MM), [shell.mesh for shell in shells]),
        ("vertex-normal offset", "integument"),
        strict=True,
    ):
        meshes = [skin, *inner]
        _draw_section(axis, meshes, *EAR)
        first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
        faces = np.concatenate([mesh.faces + start for mesh, start in zip(meshes, first, strict=False)])
        pairs = find_intersecting_faces(np.concatenate([mesh.vertices for mesh in meshes]), faces)
        axis.set_title(f"{name}: {len(pairs):,} intersecting pairs of faces in the whole set")
    return figure


def _draw_section(axis: Axes, meshes: Sequence[Mesh], plane: Plane, window: tuple[float, float, float, float]) -> None:
    low, high, left, right = window
    for mesh, colour, label in zip(meshes, COLOURS, ("skin", "1 mm", "3 mm"), strict=True):
        contours = cut(mesh, plane)
        axis.add_collection(LineCollection([c.points for c in contours], colors=colour, linewidths=0.8, label=label))
    axis.set(xlim=(low, high), ylim=(left, right), aspect="equal", xlabel="mm", ylabel="mm")
    axis.legend(loc="upper right", frameon=False)


def _depths(skin: Mesh, shells: Sequence[Shell]) -> Figure:
    """Left: depth of each layer by area. Right: where the body is too thin for 3 mm, seen from the side."""
    figure = Figure(figsize=(8, 4), layout="constrained")
    histogram, picture = figure.subplots(1, 2)
    for shell, depth, colour in zip(shells, DEPTHS_MM, COLOURS[1:], strict=True):
        areas = vertex_areas(shell.mesh)
        bins = np.linspace(0, 1.1, 56)
        histogram.hist(
            shell.depth_mm / depth, bins=bins, weights=areas / areas.sum(), histtype="step", color=colour, label=f"{depth:g} mm"
        )
    histogram.set(yscale="log", xlabel="depth reached / depth asked for", ylabel="share of the layer's area")
    histogram.legend(loc="upper left", frameon=False)

    normals = vertex_normals(skin.vertices, skin.faces, "area")
    deepest = DEPTHS_MM[-1]
    reach = measure_reach(skin.vertices, skin.faces, normals, largest_mm=2 * deepest)
    chosen = (skin.vertices[skin.faces, 1] > HEAD_FROM_MM).all(axis=1) & (skin.vertices[skin.faces, 0] > 0).all(axis=1)
    triangles = skin.triangles()[chosen]
    order = np.argsort(triangles[:, :, 0].mean(axis=1), kind="stable")  # far ones first
    room = np.minimum(REACH_SHARE * reach, deepest)[skin.faces[chosen]].mean(axis=1)
    drawn = PolyCollection(
        list(triangles[order][:, :, [2, 1]]), array=room[order], cmap="viridis", edgecolors="face", linewidths=0.1
    )
    picture.add_collection(drawn)
    picture.set(aspect="equal", xlabel="mm", ylabel="mm", title="room below the skin of the head's left side")
    picture.autoscale_view()
    picture.invert_xaxis()
    figure.colorbar(drawn, ax=picture, label=f"{REACH_SHARE:g} · reach, up to {deepest:g} mm")
    return figure


if __name__ == "__main__":
    main()
