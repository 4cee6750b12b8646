"""The border of a sheet: where it ends inside of the body it shall run evenly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges, vertex_neighbours
from core.geometry.components import find_split_vertices
from core.geometry.laplacian import neighbour_means
from core.geometry.normals import face_crosses, normalised

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

TRIMMINGS = 3  # times that faces which stick out are taken off
EVENINGS = 10


def border_sides(faces: Ints) -> Ints:
    """Sides (B, 2) with one face, from start to end as the face runs."""
    net = edges(faces.astype(np.int32))
    face, side = np.nonzero(net.face_count[net.of_face] == 1)
    return np.column_stack((faces[face, side], faces[face, (side + 1) % 3]))


def trim(faces: Ints, inside: Flags) -> Ints:
    """Without faces that stick out of the border within the body, and without those that hang by a corner; (G, 3)."""
    for _ in range(TRIMMINGS):
        net = edges(faces.astype(np.int32))
        bare = (net.face_count[net.of_face] == 1).sum(axis=1) >= 2
        out = bare & inside[faces].all(axis=1)
        if not out.any():
            break
        faces = faces[~out]
    while len(faces):
        split = find_split_vertices(faces.astype(np.int32), edges(faces.astype(np.int32)))
        if len(split) == 0:
            break
        faces = faces[~np.isin(faces, split).any(axis=1)]
    return faces


def even_border(points: Floats, faces: Ints, inside: Flags) -> Floats:
    """The border within the body straightened, and the triangles next to it evened out; (P, 3)."""
    sides = border_sides(faces)
    at_border = np.zeros(len(points), dtype=np.bool_)
    at_border[sides] = True
    line = vertex_neighbours(np.sort(sides, axis=1), len(points))
    moving = np.flatnonzero(at_border & inside)
    # where the border leaves the body its course is given
    moving = np.array([vertex for vertex in moving if inside[line[int(vertex)]].all()], dtype=np.int64)
    net = vertex_neighbours(edges(faces.astype(np.int32)).ends, len(points))
    inner = np.flatnonzero(~at_border & inside)
    points = points.copy()
    for _ in range(EVENINGS if len(moving) else 0):
        points[moving] += 0.5 * (neighbour_means(points, line, moving) - points[moving])
        points[inner] += 0.5 * (neighbour_means(points, net, inner) - points[inner])
    return points


def outwards(points: Floats, faces: Ints) -> Floats:
    """Unit directions (P, 3) along the sheet away from it at vertices of the border, zero elsewhere."""
    net = edges(faces.astype(np.int32))
    face, side = np.nonzero(net.face_count[net.of_face] == 1)
    start, end = faces[face, side], faces[face, (side + 1) % 3]
    away = np.cross(points[end] - points[start], face_crosses(points, faces.astype(np.int32))[face])
    away = normalised(away)
    total = np.zeros_like(points)
    np.add.at(total, start, away)
    np.add.at(total, end, away)
    return normalised(total)
