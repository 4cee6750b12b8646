"""Thesis 4.1 made again: shells by Eq. (4.1), and the intersections that Chapter 5 then mends by hand."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations_with_replacement

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from core.geometry.exact_intersection import find_intersecting_faces
from core.mesh import Mesh
from core.reports.figures.view import Surface, View, look

Floats = NDArray[np.float64]
STEP_MM = 0.1  # "a small increment on the order of 0.1 mm"
GREY, RED = (170, 170, 170), (214, 30, 30)


def shrunken(skin: Mesh, depths_mm: Mapping[str, float]) -> dict[str, Mesh]:
    """The skin and its shells at these depths, step by step inwards; nothing looks after crossings."""
    vertices, done, made = skin.vertices.copy(), 0, {"skin": skin}
    for name, depth in depths_mm.items():
        for _ in range(round(depth / STEP_MM) - done):
            vertices = vertices - STEP_MM * _direction(vertices, skin.faces)
            done += 1
        made[name] = skin.with_vertices(vertices)
    return made


def _direction(vertices: Floats, faces: NDArray[np.int32]) -> Floats:
    """n0 / |n0|², n0 the mean of the normals around a vertex, weighted by one over the areas."""
    first, second, third = vertices[faces].transpose(1, 0, 2)
    crossed = np.cross(second - first, third - first)
    double_areas = np.maximum(np.linalg.norm(crossed, axis=1), 1e-300)
    weights = 1.0 / double_areas
    weighted = crossed / double_areas[:, None] * weights[:, None]
    total, weight = np.zeros_like(vertices), np.zeros(len(vertices))
    for corner in range(3):
        np.add.at(total, faces[:, corner], weighted)
        np.add.at(weight, faces[:, corner], weights)
    mean = total / weight[:, None]
    # where normals cancel the equation has no bound; it is cut off so that the sum of all steps stays finite
    length_squared = np.maximum((mean**2).sum(axis=1), 0.01)
    return mean / length_squared[:, None]


def crossings(surfaces: Mapping[str, Mesh]) -> tuple[dict[tuple[str, str], int], dict[str, NDArray[np.bool_]]]:
    """Pairs of faces that cross, within and between surfaces, and which faces of each take part."""
    names = list(surfaces)
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in surfaces.values())])
    faces = [mesh.faces.astype(np.int64) + start for mesh, start in zip(surfaces.values(), first, strict=False)]
    pairs = find_intersecting_faces(np.concatenate([m.vertices for m in surfaces.values()]), np.concatenate(faces))
    owner = np.repeat(np.arange(len(names)), [len(each) for each in faces])
    owners = np.sort(owner[pairs], axis=1)
    counts = {
        (names[a], names[b]): int(((owners[:, 0] == a) & (owners[:, 1] == b)).sum())
        for a, b in combinations_with_replacement(range(len(names)), 2)
    }
    taken = np.zeros(len(owner), dtype=bool)
    taken[pairs.ravel()] = True
    return counts, {name: taken[owner == row] for row, name in enumerate(names)}


def crossings_figure(mesh: Mesh, taken: NDArray[np.bool_], windows: Mapping[str, View]) -> Figure:
    """Figs. 43 and 44: the faces of a shell that cross others, in red."""
    colours = np.where(taken[:, None], RED, GREY).astype(np.uint8)
    surface = Surface.of(mesh)
    figure = Figure(figsize=(9, 3.4), layout="constrained")
    for axes, (title, view) in zip(figure.subplots(1, len(windows)), windows.items(), strict=True):
        axes.imshow(look(surface, view).paint(colours), interpolation="lanczos")
        axes.set_title(title, fontsize=9)
        axes.set_axis_off()
    return figure
