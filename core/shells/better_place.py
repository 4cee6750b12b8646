"""Where a vertex serves the worst of its faces best, without leaving the surface."""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.connectivity import Connectivity
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

DIRECTIONS = 8
STEPS = 10
FIRST_STEP = 0.25  # of the mean distance to the neighbours
HALVED_BELOW = 0.02  # of that distance: finer is not searched
UPRIGHT = 0.3  # cosine: no face turns further against the normal at the vertex


def better_places(vertices: Vertices, net: Connectivity, chosen: Ints) -> Floats:
    """For each chosen vertex (N,) a place in its tangent plane that lifts the lowest q around it, (N, 3) mm.

    Each as if it alone moved: pattern search, the place itself if there is none better.
    """
    places = vertices[chosen]
    _search(vertices, net.faces, net.faces_around.start, net.faces_around.values, net.neighbours.values, chosen, places)
    return places


@njit(cache=True, nogil=True)
def _search(
    vertices: Vertices,
    faces: Faces,
    start: Ints,
    around: NDArray[np.int32],
    neighbours: NDArray[np.int32],
    chosen: Ints,
    places: Floats,
) -> None:
    """places (N, 3) must hold where the vertices are."""
    normal, first, second, trial = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(len(chosen)):
        vertex = chosen[i]
        if not _frame(vertices, faces, start[vertex], start[vertex + 1], around, normal, first, second):
            continue
        size = 0.0
        for k in range(start[vertex], start[vertex + 1]):
            squared = 0.0
            for axis in range(3):
                squared += (vertices[neighbours[k], axis] - vertices[vertex, axis]) ** 2
            size += math.sqrt(squared) / (start[vertex + 1] - start[vertex])
        step = FIRST_STEP * size
        best = _lowest(vertices, faces, start[vertex], start[vertex + 1], around, vertex, places[i], normal)
        for _ in range(STEPS):
            x, y, z, found = places[i, 0], places[i, 1], places[i, 2], best
            for turn in range(DIRECTIONS):
                angle = 2.0 * math.pi * turn / DIRECTIONS
                for axis in range(3):
                    trial[axis] = places[i, axis] + step * (math.cos(angle) * first[axis] + math.sin(angle) * second[axis])
                lowest = _lowest(vertices, faces, start[vertex], start[vertex + 1], around, vertex, trial, normal)
                if lowest > found:
                    x, y, z, found = trial[0], trial[1], trial[2], lowest
            if found > best:
                places[i, 0], places[i, 1], places[i, 2], best = x, y, z, found
            else:
                step *= 0.5
                if step < HALVED_BELOW * size:
                    break


@njit(cache=True, nogil=True)
def _frame(
    vertices: Vertices,
    faces: Faces,
    begin: int,
    end: int,
    around: NDArray[np.int32],
    normal: Floats,
    first: Floats,
    second: Floats,
) -> bool:
    """Unit normal, weighted by area, and two directions along the surface; False if the faces cancel out."""
    normal[:] = 0.0
    for k in range(begin, end):
        p, q, r = faces[around[k], 0], faces[around[k], 1], faces[around[k], 2]
        ux, uy, uz = vertices[q, 0] - vertices[p, 0], vertices[q, 1] - vertices[p, 1], vertices[q, 2] - vertices[p, 2]
        vx, vy, vz = vertices[r, 0] - vertices[p, 0], vertices[r, 1] - vertices[p, 1], vertices[r, 2] - vertices[p, 2]
        normal[0] += uy * vz - uz * vy
        normal[1] += uz * vx - ux * vz
        normal[2] += ux * vy - uy * vx
    length = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    if length == 0.0:
        return False
    normal /= length
    flattest = np.argmin(np.abs(normal))
    for axis in range(3):
        first[axis] = -normal[flattest] * normal[axis]
    first[flattest] += 1.0
    first /= math.sqrt(first[0] ** 2 + first[1] ** 2 + first[2] ** 2)
    second[0] = normal[1] * first[2] - normal[2] * first[1]
    second[1] = normal[2] * first[0] - normal[0] * first[2]
    second[2] = normal[0] * first[1] - normal[1] * first[0]
    return True


@njit(cache=True, nogil=True)
def _lowest(
    vertices: Vertices,
    faces: Faces,
    begin: int,
    end: int,
    around: NDArray[np.int32],
    vertex: int,
    place: Floats,
    normal: Floats,
) -> float:
    """Lowest q around a vertex if it stood at place (3,); -1 for a face that leans over too far."""
    lowest = 1.0
    for k in range(begin, end):
        face = around[k]
        at = 0 if faces[face, 0] == vertex else (1 if faces[face, 1] == vertex else 2)
        q, r = faces[face, (at + 1) % 3], faces[face, (at + 2) % 3]
        ux, uy, uz = vertices[q, 0] - place[0], vertices[q, 1] - place[1], vertices[q, 2] - place[2]
        vx, vy, vz = vertices[r, 0] - place[0], vertices[r, 1] - place[1], vertices[r, 2] - place[2]
        wx, wy, wz = vx - ux, vy - uy, vz - uz
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        squared = x * x + y * y + z * z
        a = math.sqrt(ux * ux + uy * uy + uz * uz)
        b = math.sqrt(vx * vx + vy * vy + vz * vz)
        c = math.sqrt(wx * wx + wy * wy + wz * wz)
        product = a * b * c * (a + b + c)
        if product == 0.0:
            return -1.0
        shape = 4.0 * squared / product
        if x * normal[0] + y * normal[1] + z * normal[2] < UPRIGHT * math.sqrt(squared):
            shape -= 1.0  # so that a vertex whose faces lean already may still be set upright
        lowest = min(lowest, shape)
    return lowest
