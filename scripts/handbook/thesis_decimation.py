"""Thesis Chapter 3 made again: its measure of curvature, its script, and what this service does instead."""

from __future__ import annotations

from collections.abc import Mapping

import manifold3d
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from core.decimation.curvature import mean_neighbour_angles_deg
from core.decimation.decimate import decimate
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.normals import face_normals
from core.geometry.quality import quality
from core.mesh import Mesh
from core.schema.decimate import DecimateInputs
from subjects.generated.revolved import star_shape
from subjects.generated.solid import mesh_of

UPLOAD = {"href": "/v1/meshes/00000000-0000-4000-8000-000000000000"}
ITERATIONS = 25  # as in Figs. 26, 30 and 31; each takes two faces
LARGEST_DEG = 20.0


def bladder() -> Mesh:
    """A stand-in for the thesis' bladder, which is not ours to ship: 1,280 faces, flat on one side, dented on the other."""

    def radius(directions: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y, z = directions.T
        flat: NDArray[np.float64] = 30.0 / np.maximum(1.0, 1.35 * z) + 3.0 * np.sin(3 * x) * np.cos(2 * y)
        return flat

    return star_shape(radius, 3).rounded_to_float32()


def decimated_bladders() -> dict[str, Mesh]:
    """Title -> surface, in the thesis' order."""
    before = bladder()
    fewer = len(before.faces) - 2 * ITERATIONS
    return {
        f"before: {len(before.faces):,} faces": before,
        f"thesis, {ITERATIONS} iterations, no smoothing": _thinned(before, fewer, literal=True, smooth_weight=0.0),
        f"thesis, {ITERATIONS} iterations, smoothing": _thinned(before, fewer, literal=True),
        "Integument, as many faces": _thinned(before, fewer),
    }


def quarter_numbers() -> dict[str, dict[str, float]]:
    """Down to a quarter of the faces: lowest and mean q, and pairs of faces that cross."""
    before = bladder()
    wanted = len(before.faces) // 4
    made = {
        "thesis, no smoothing": _thinned(before, wanted, literal=True, smooth_weight=0.0),
        "thesis, smoothing": _thinned(before, wanted, literal=True),
        "Integument": _thinned(before, wanted),
    }
    return {name: {**qualities(mesh), "crossing pairs": float(len(_crossings(mesh)))} for name, mesh in made.items()}


def qualities(mesh: Mesh) -> dict[str, float]:
    """Of the triangles."""
    values = quality(mesh.vertices, mesh.faces)
    return {"faces": len(mesh.faces), "lowest q": float(values.min()), "mean q": float(values.mean())}


def curvature_figure() -> Figure:
    """Fig. 24: flat caps are 0, the rim is what bends most, the wall lies between."""
    cylinder = mesh_of(manifold3d.Manifold.cylinder(40.0, 20.0, 20.0, 64), 6.0)
    figure = Figure(figsize=(4.2, 3.2), layout="constrained")
    axes = figure.subplots()
    drawn = _draw(axes, cylinder, np.array([0.5, -0.62, 0.6]), np.array([0.0, 0.0, 1.0]))
    figure.colorbar(drawn, ax=axes, label="mean angle to neighbours, °", shrink=0.8)
    return figure


def decimation_figure(surfaces: Mapping[str, Mesh]) -> Figure:
    """Figs. 25, 26, 30 and 31."""
    figure = Figure(figsize=(9, 2.9), layout="constrained")
    many = figure.subplots(1, len(surfaces))
    for axes, (title, mesh) in zip(many, surfaces.items(), strict=True):
        drawn = _draw(axes, mesh, np.array([0.25, -0.3, 0.92]), np.array([0.0, 1.0, 0.0]))
        axes.set_title(f"{title}\nlowest q {qualities(mesh)['lowest q']:.2g}", fontsize=7.5)
    figure.colorbar(drawn, ax=many[-1], label="mean angle to neighbours, °", shrink=0.8)
    return figure


def _thinned(mesh: Mesh, faces: int, **wanted: object) -> Mesh:
    inputs = DecimateInputs.model_validate({"mesh": UPLOAD, "target_faces": faces, **wanted})
    return decimate({"bladder": mesh}, inputs)["bladder"].mesh


def _crossings(mesh: Mesh) -> NDArray[np.int64]:
    return find_intersecting_faces(mesh.vertices, mesh.faces)


def _draw(axes: Axes, mesh: Mesh, toward: NDArray[np.float64], upwards: NDArray[np.float64]) -> PolyCollection:
    toward = toward / np.linalg.norm(toward)
    right = np.cross(upwards, toward)
    right = right / np.linalg.norm(right)
    flat = np.array([right, np.cross(toward, right)]).T
    seen = face_normals(mesh.vertices, mesh.faces) @ toward > 0
    triangles = mesh.triangles()
    order = np.flatnonzero(seen)[np.argsort(triangles[seen].mean(axis=1) @ toward, kind="stable")]
    faces = PolyCollection(list(triangles[order] @ flat), edgecolors="black", linewidths=0.3, cmap="viridis")
    faces.set_array(mean_neighbour_angles_deg(mesh)[order])
    faces.set_clim(0.0, LARGEST_DEG)
    axes.add_collection(faces)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.set_axis_off()
    return faces
