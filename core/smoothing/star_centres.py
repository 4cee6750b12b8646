"""Centres of the faces around a vertex, weighted by area: where CVT and WCC smoothing send it (thesis Eqs. 3.3, 3.4)."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.adjacency import Rows
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def centroid_centres(vertices: Vertices, faces: Faces, around: Rows, chosen: Ints, *, equal: bool) -> Floats:
    """Mean of the centroids of the faces around each chosen vertex, weighted by their areas unless `equal`; (K, 3) mm.

    around: faces of each vertex. Source: thesis Eq. (3.3).
    """
    return _centres(vertices, faces, around, chosen, equal, False)


def circumcentre_centres(vertices: Vertices, faces: Faces, around: Rows, chosen: Ints, *, equal: bool) -> Floats:
    """Mean of the circumcentres of the faces around each chosen vertex, weighted by their areas unless `equal`; (K, 3) mm.

    The circumcentre of a needle is far away, but its area times that stays finite and is computed as a whole; with `equal`
    nothing tames it. Source: thesis Eq. (3.4).
    """
    return _centres(vertices, faces, around, chosen, equal, True)


def _centres(vertices: Vertices, faces: Faces, around: Rows, chosen: Ints, equal: bool, circum: bool) -> Floats:
    centres = np.empty((len(chosen), 3))
    _fill(vertices, faces, around.start, around.values, chosen, equal, circum, centres)
    return centres


@njit(cache=True, nogil=True)
def _fill(
    vertices: Vertices,
    faces: Faces,
    start: Ints,
    around: NDArray[np.int32],
    chosen: Ints,
    equal: bool,
    circum: bool,
    centres: Floats,
) -> None:
    """centres (K, 3) is filled, measured from the vertex so that no digits are lost far from the origin."""
    for i in range(len(chosen)):
        vertex = chosen[i]
        px, py, pz = vertices[vertex, 0], vertices[vertex, 1], vertices[vertex, 2]
        x, y, z, total = 0.0, 0.0, 0.0, 0.0
        for k in range(start[vertex], start[vertex + 1]):
            face = around[k]
            at = 0
            while faces[face, at] != vertex:
                at += 1
            b, c = faces[face, (at + 1) % 3], faces[face, (at + 2) % 3]
            ux, uy, uz = vertices[b, 0] - px, vertices[b, 1] - py, vertices[b, 2] - pz
            vx, vy, vz = vertices[c, 0] - px, vertices[c, 1] - py, vertices[c, 2] - pz
            nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            doubled_area = math.sqrt(nx * nx + ny * ny + nz * nz)
            if doubled_area == 0.0:
                continue
            weight = 1.0 if equal else 0.5 * doubled_area
            total += weight
            if circum:
                # circumcentre - p = (|u|² v × n + |v|² n × u) / 2 |n|², n = u × v; its weight cancels one |n|
                uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
                scale = (0.5 / doubled_area if equal else 0.25) / doubled_area
                x += scale * (uu * (vy * nz - vz * ny) + vv * (ny * uz - nz * uy))
                y += scale * (uu * (vz * nx - vx * nz) + vv * (nz * ux - nx * uz))
                z += scale * (uu * (vx * ny - vy * nx) + vv * (nx * uy - ny * ux))
            else:
                x, y, z = x + weight * (ux + vx) / 3.0, y + weight * (uy + vy) / 3.0, z + weight * (uz + vz) / 3.0
        if total == 0.0:
            total = 1.0
        centres[i, 0], centres[i, 1], centres[i, 2] = px + x / total, py + y / total, pz + z / total
