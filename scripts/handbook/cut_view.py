"""Nested surfaces cut open: what is behind a plane as solid bodies, and on the plane each tissue filled with its colour."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from numpy.typing import NDArray

from core.geometry.normals import vertex_normals
from core.geometry.section import Plane, cut
from core.mesh import Mesh
from core.reports.figures.view import Surface, View, look
from core.reports.palette import Colour, as_hex

Floats = NDArray[np.float64]


def draw_cut(axes: Axes, surfaces: Mapping[str, Mesh], colours: Mapping[str, Colour], view: View, plane: Plane | None) -> None:
    """Surfaces, outermost first, seen by `view`; what lies on the side `plane.normal` points to is taken away.

    The viewer must look at the cut: then nothing that is left can hide it, and the sections are laid over the picture."""
    kept = {name: _behind(mesh, plane) if plane is not None else Surface.of(mesh) for name, mesh in surfaces.items()}
    first = np.cumsum([0, *(len(surface.mesh.vertices) for surface in kept.values())])
    faces = [surface.mesh.faces.astype(np.int64) + start for surface, start in zip(kept.values(), first, strict=False)]
    whole = Mesh.of(np.concatenate([surface.mesh.vertices for surface in kept.values()]), np.concatenate(faces))
    painted = np.concatenate([np.tile(np.asarray(colours[name], np.uint8), (len(kept[name].mesh.faces), 1)) for name in kept])
    picture = look(Surface(whole, np.concatenate([surface.normals for surface in kept.values()])), view).paint(painted)
    axes.imshow(picture, extent=(view.low[0], view.high[0], view.low[1], view.high[1]), interpolation="lanczos")
    for order, (name, mesh) in enumerate(surfaces.items() if plane is not None else ()):
        _fill(axes, mesh, colours[name], view, plane, order)
    axes.set(xlim=(view.low[0], view.high[0]), ylim=(view.low[1], view.high[1]), aspect="equal")
    axes.set_axis_off()


def _fill(axes: Axes, mesh: Mesh, colour: Colour, view: View, plane: Plane | None, order: int) -> None:
    if plane is None:
        return
    contours = [contour.points for contour in cut(mesh, plane) if contour.closed]
    if contours:
        rings = [view.flatten(plane.origin + points @ np.array([plane.right, plane.up])) for points in contours]
        path = Path.make_compound_path(*(Path(ring, closed=False) for ring in rings))
        axes.add_artist(PathPatch(path, facecolor=as_hex(colour), edgecolor="black", linewidth=0.25, zorder=10 + order))


def _behind(mesh: Mesh, plane: Plane) -> Surface:
    """The part on the far side of the plane; faces across it are cut to the line."""
    normals = vertex_normals(mesh.vertices, mesh.faces, "area")
    heights = (mesh.vertices - plane.origin) @ plane.normal
    inside = heights < 0
    count = inside[mesh.faces].sum(axis=1)
    corners = [mesh.faces[count == 3]]
    points, directions, new = [mesh.vertices], [normals], len(mesh.vertices)
    for wanted in (1, 2):
        faces = mesh.faces[count == wanted]
        # turned so that the corner which is alone on its side comes first
        alone = np.argmax(inside[faces] == (wanted == 1), axis=1)
        turned = np.take_along_axis(faces, (alone[:, None] + np.arange(3)) % 3, axis=1).astype(np.int64)
        for end in (1, 2):
            share = (heights[turned[:, 0]] / (heights[turned[:, 0]] - heights[turned[:, end]]))[:, None]
            points.append(mesh.vertices[turned[:, 0]] * (1 - share) + mesh.vertices[turned[:, end]] * share)
            directions.append(normals[turned[:, 0]] * (1 - share) + normals[turned[:, end]] * share)
        onto_second, onto_third = new + np.arange(len(faces)), new + len(faces) + np.arange(len(faces))
        new += 2 * len(faces)
        if wanted == 1:
            corners.append(np.column_stack([turned[:, 0], onto_second, onto_third]))
        else:
            corners.append(np.column_stack([onto_second, turned[:, 1], turned[:, 2]]))
            corners.append(np.column_stack([onto_second, turned[:, 2], onto_third]))
    return Surface(Mesh.of(np.concatenate(points), np.concatenate(corners)), np.concatenate(directions))
