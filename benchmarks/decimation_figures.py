"""`python -m benchmarks.decimation_figures [FOLDER]`: the picture of docs/algorithms/decimation.md."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from core.decimation.curvature import mean_neighbour_angles_deg
from core.decimation.decimate import decimate
from core.geometry.normals import face_normals
from core.mesh import Mesh
from core.schema.decimate import DecimateInputs
from subjects.body import body

UPLOAD = {"href": "/v1/meshes/00000000-0000-4000-8000-000000000000"}
WINDOW = (-95.0, 95.0, 600.0, 790.0)  # of the face, mm
LARGEST_DEG = 30.0


def main() -> None:
    """The folder defaults to docs/algorithms."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/algorithms")
    mpl.use("Agg")
    before = body(0)
    figure = Figure(figsize=(9.6, 3.6), layout="constrained")
    meshes = {"26,756 faces": before}
    for method in ("curvature", "quadric"):
        inputs = DecimateInputs.model_validate({"mesh": UPLOAD, "method": method, "target_ratio": 0.25})
        meshes[f"{method}, a quarter of the faces"] = decimate({"body": before}, inputs)["body"].mesh
    axes = figure.subplots(1, 3)
    for axis, (title, mesh) in zip(axes, meshes.items(), strict=True):
        drawn = _draw(axis, mesh)
        axis.set_title(title, fontsize=9)
    figure.colorbar(drawn, ax=axes[-1], label="mean angle to neighbours, °", shrink=0.8)
    figure.savefig(folder / "decimation-head.png", dpi=110)


def _draw(axis: mpl.axes.Axes, mesh: Mesh) -> PolyCollection:
    """The head from the front, far faces first."""
    triangles = mesh.triangles()
    seen = face_normals(mesh.vertices, mesh.faces)[:, 2] > 0.0
    middle = triangles.mean(axis=1)
    seen &= (middle[:, 1] > WINDOW[2] - 20) & (np.abs(middle[:, 0]) < WINDOW[1] + 20)
    order = np.flatnonzero(seen)[np.argsort(middle[seen, 2], kind="stable")]
    faces = PolyCollection(list(triangles[order][:, :, :2]), edgecolors="black", linewidths=0.15, cmap="viridis")
    faces.set_array(mean_neighbour_angles_deg(mesh)[order])
    faces.set_clim(0.0, LARGEST_DEG)
    axis.add_collection(faces)
    axis.set(xlim=WINDOW[:2], ylim=WINDOW[2:], aspect="equal", xticks=[], yticks=[])
    return faces


if __name__ == "__main__":
    main()
