"""`python -m benchmarks.smoothing_figures [FOLDER]`: the pictures of docs/algorithms/smoothing.md, and its numbers."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from time import process_time
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from core.geometry.adjacency import edges
from core.geometry.distance import closest_points
from core.geometry.quality import quality
from core.geometry.section import Plane, cut
from core.mesh import Mesh
from core.schema.smooth import SmoothInputs
from core.smoothing.smooth import Smoothed, smooth
from subjects.body import body
from subjects.plate import plate

UPLOAD = {"href": "/v1/meshes/00000000-0000-0000-0000-000000000000"}
EQUATIONS = ("standard", "lumped", "cvt", "wcc")
COLOURS = {
    "standard": "#0072b2", "lumped": "#56b4e9", "cvt": "#009e73", "wcc": "#d55e00", "hc": "#cc79a7", "taubin": "#e69f00",
    "cvt, along the surface": "#000000",
}  # fmt: skip
EAR = (Plane.of((0, 725, 0), (0, 0, 1), (1, 0, 0)), (26, 68, 62, 91))
FINGERS = (Plane.of((0, 150, 0), (1, 0, 0), (0, 0, 1)), (460, 500, 232, 300))
NOISE = 0.1  # standard deviation on every coordinate, as a share of the shortest edge at the vertex
ITERATIONS = 20


def main() -> None:
    """The folder defaults to docs/algorithms; numbers go to standard output."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/algorithms")
    mpl.use("Agg")
    mpl.rcParams.update({"font.size": 8, "axes.titlesize": 8, "svg.hashsalt": "integument"})
    _plate().savefig(folder / "smoothing-plate.png", dpi=110)
    skin = body(1)
    runs = {method: _smoothed(skin, method=method, stop="iterations") for method in (*EQUATIONS, "hc", "taubin")}
    runs["cvt, along the surface"] = _smoothed(skin, method="cvt", stop="iterations", along_surface=True)
    _course(runs).savefig(folder / "smoothing-course.png", dpi=110)
    _print_rows(runs)
    _sections(skin, _noisy(skin)).savefig(folder / "smoothing-noise.png", dpi=110)


def _smoothed(mesh: Mesh, **wanted: Any) -> Smoothed:
    return smooth({"it": mesh}, SmoothInputs.model_validate({"mesh": UPLOAD, "iterations": ITERATIONS, **wanted}))["it"]


def _noisy(mesh: Mesh) -> Mesh:
    ends = edges(mesh.faces).ends
    lengths = np.linalg.norm(mesh.vertices[ends[:, 0]] - mesh.vertices[ends[:, 1]], axis=1)
    shortest = np.full(len(mesh.vertices), np.inf)
    np.minimum.at(shortest, ends.ravel(), np.repeat(lengths, 2))
    noise = np.random.default_rng(0).normal(0.0, NOISE, mesh.vertices.shape)
    return mesh.with_vertices(mesh.vertices + shortest[:, None] * noise)


def _plate() -> Figure:
    before = plate()
    figure = Figure(figsize=(9.6, 3.4), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    runs = {method: _smoothed(before, method=method) for method in EQUATIONS}
    nine = _smoothed(before, method="wcc", iterations=9)
    for axis, mesh, title in ((left, before, "plate"), (middle, nine.mesh, f"wcc, {nine.delivered} iterations")):
        drawn = _draw_quality(axis, mesh)
        axis.set_title(f"{title}: lowest q {quality(mesh.vertices, mesh.faces).min():.2g}")
    figure.colorbar(drawn, ax=middle, label="q", shrink=0.8)
    for method, run in runs.items():
        lowest = [state.lowest_quality for state in run.progress]
        right.plot(range(1, len(lowest)), lowest[1:], color=COLOURS[method], label=method)
        right.plot([run.delivered], [lowest[run.delivered]], "o", color=COLOURS[method], markersize=4)
        print(f"plate, {method}: {lowest[0]:.2g} -> {lowest[run.delivered]:.3f} in {run.delivered} iterations")
    right.set(xlabel="iteration", ylim=(0.4, 0.8), title="lowest q (4e-5 before); dot: delivered")
    right.legend(frameon=False)
    return figure


def _draw_quality(axis: Axes, mesh: Mesh) -> PolyCollection:
    drawn = PolyCollection(list(mesh.triangles()[:, :, :2]), cmap="viridis", edgecolors="#333333", linewidths=0.25)
    drawn.set_array(quality(mesh.vertices, mesh.faces))
    drawn.set_clim(0.4, 1.0)
    axis.add_collection(drawn)
    axis.set(xlim=(-1, 101), ylim=(-1, 101), aspect="equal")
    axis.axis("off")
    return drawn


def _course(runs: Mapping[str, Smoothed]) -> Figure:
    figure = Figure(figsize=(9.6, 2.8), layout="constrained")
    mean, volume = figure.subplots(1, 2)
    for name, run in runs.items():
        mean.plot([state.mean_quality for state in run.progress], color=COLOURS[name], label=name)
        volumes = np.array([state.volume_mm3 for state in run.progress], dtype=float)
        volume.plot(100.0 * (volumes / volumes[0] - 1.0), color=COLOURS[name], label=name)
    mean.set(xlabel="iteration", xticks=range(0, ITERATIONS + 1, 5), title="mean quality q")
    volume.set(xlabel="iteration", xticks=range(0, ITERATIONS + 1, 5), title="change of volume, %")
    volume.set_yscale("symlog", linthresh=1.0)
    mean.legend(frameon=False, fontsize=7, ncols=2)
    return figure


def _print_rows(runs: Mapping[str, Smoothed]) -> None:
    for name, run in runs.items():
        fact, before, after = run.changes[0], run.progress[0], run.progress[-1]
        held = sum(state.held + state.shortened for state in run.progress)
        print(
            f"body, {name}: lowest q {before.lowest_quality:.4f} -> {after.lowest_quality:.4f}, "
            f"mean {before.mean_quality:.3f} -> {after.mean_quality:.3f}, volume {100 * fact['volume_change']:+.2f} %, "
            f"deviation max {fact['max_deviation_mm']:.2f} rms {fact['rms_deviation_mm']:.4f} mm, "
            f"{held} steps of {ITERATIONS * len(run.shift_mm)} shortened"
        )


def _sections(skin: Mesh, noisy: Mesh) -> Figure:
    figure = Figure(figsize=(9.6, 4.8), layout="constrained")
    rows = figure.subplots(2, 4)
    runs: dict[str, Mesh] = {"with noise": noisy}
    for method in ("standard", "hc", "taubin"):
        start = process_time()
        runs[method] = _smoothed(noisy, method=method, stop="iterations").mesh
        taken = process_time() - start
        off = closest_points(skin.vertices, skin.faces, runs[method].vertices)[0]
        print(f"noise, {method}: {taken:.1f} s CPU, rms from the body without noise {np.sqrt((off**2).mean()):.4f} mm")
    for number, (plane, window) in enumerate((EAR, FINGERS)):
        for axis, (name, mesh) in zip(rows[number], runs.items(), strict=True):
            for drawn, colour in ((skin, "#aaaaaa"), (mesh, "#d55e00")):
                axis.add_collection(
                    LineCollection([contour.points for contour in cut(drawn, plane)], colors=colour, linewidths=0.9)
                )
            axis.set(xlim=window[:2], ylim=window[2:], aspect="equal", xticks=[], yticks=[])
            if number == 0:
                axis.set_title(name)
    return figure


if __name__ == "__main__":
    main()
