"""A grid of voxel centres cut into tetrahedra, six to a cube, and the surface between its nodes inside and outside a region.

Whatever the region, the surface is closed and manifold and does not run through itself: within a tetrahedron it is one triangle
or two, and neighbours agree on the face they share. All six tetrahedra of a cube go round its main diagonal (Kuhn subdivision).
Source: Bloomenthal 1988, doi:10.1016/0167-8396(88)90013-1; Kuhn 1960, doi:10.1147/rd.45.0518.
"""

from __future__ import annotations

from itertools import permutations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Ints: TypeAlias = NDArray[np.int64]
Flags: TypeAlias = NDArray[np.bool_]

DIRECTIONS = np.array([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1), (1, 1, 1)])
"""Edges of the grid, from a node to the one after it."""
NEIGHBOURS = np.zeros((3, 3, 3), dtype=np.bool_)
"""A node and the 14 that edges lead to: what hangs together in this way has one surface."""
NEIGHBOURS[1, 1, 1] = True
for _step in DIRECTIONS:
    NEIGHBOURS[tuple(1 + _step)] = NEIGHBOURS[tuple(1 - _step)] = True


def _paths() -> NDArray[np.int64]:
    """The tetrahedra of a cube, (6, 4, 3): from (0, 0, 0) to (1, 1, 1) along the axes in every order, right-handed."""
    cells = []
    for order in permutations(range(3)):
        corners = np.zeros((4, 3), dtype=np.int64)
        for place, axis in enumerate(order):
            corners[place + 1 :, axis] += 1
        sides = corners[1:] - corners[0]
        cells.append(corners if np.linalg.det(sides) > 0 else corners[[0, 2, 1, 3]])
    return np.array(cells)


TETRAHEDRA = _paths()


def _cut(inside: int) -> list[tuple[tuple[int, int], ...]]:
    """Triangles of the surface in a right-handed tetrahedron, counter-clockwise from outside, as edges (corner inside, corner
    outside). `inside` has a bit for each corner."""
    within = [corner for corner in range(4) if inside >> corner & 1]
    without = [corner for corner in range(4) if not inside >> corner & 1]
    if len(within) in (0, 4):
        return []
    if len(within) == 1:
        polygon = [(within[0], other) for other in without]
    elif len(within) == 3:
        polygon = [(other, without[0]) for other in within]
    else:
        (a, b), (c, d) = within, without
        polygon = [(a, c), (a, d), (b, d), (b, c)]
    # any right-handed tetrahedron tells which way round is outward
    places = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
    corners = np.array([(places[a] + places[b]) / 2 for a, b in polygon])
    outward = places[without].mean(axis=0) - places[within].mean(axis=0)
    if np.cross(corners[1] - corners[0], corners[2] - corners[0]) @ outward < 0:
        polygon = polygon[::-1]
    return [(polygon[0], polygon[i], polygon[i + 1]) for i in range(1, len(polygon) - 1)]


CUTS = [_cut(inside) for inside in range(16)]


def surface_between(inside: Flags) -> tuple[Ints, Ints]:
    """The surface around `inside` (I, J, K), whose outermost layer must be False: (ends (V, 2), faces (F, 3)).

    ends: flat numbers of the two nodes, inside and outside, between which each vertex lies. Vertices are in the order of these
    numbers. Faces are counter-clockwise seen from outside if voxel axes are right-handed in space.
    """
    shape = inside.shape
    strides = np.array([shape[1] * shape[2], shape[2], 1])
    flat = inside.ravel()
    cubes = _mixed_cubes(inside)
    first_ends, second_ends = [], []
    for corners in TETRAHEDRA:
        nodes = cubes[:, None] + (corners @ strides)[None, :]
        case = flat[nodes] @ np.array([1, 2, 4, 8])
        for number, triangles in enumerate(CUTS):
            if not triangles:
                continue
            here = nodes[case == number]
            for triangle in triangles:
                first_ends.append(here[:, [within for within, _without in triangle]])
                second_ends.append(here[:, [without for _within, without in triangle]])
    first, second = np.concatenate(first_ends), np.concatenate(second_ends)
    keys, faces = np.unique(first.ravel() * flat.size + second.ravel(), return_inverse=True)
    return np.column_stack(np.divmod(keys, flat.size)), faces.reshape(-1, 3).astype(np.int64)


def _mixed_cubes(inside: Flags) -> Ints:
    """Flat numbers of the first corners of cubes that have corners both inside and outside."""
    some = inside[:-1] | inside[1:]
    every = inside[:-1] & inside[1:]
    some, every = some[:, :-1] | some[:, 1:], every[:, :-1] & every[:, 1:]
    some, every = some[:, :, :-1] | some[:, :, 1:], every[:, :, :-1] & every[:, :, 1:]
    return np.ravel_multi_index(np.nonzero(some & ~every), inside.shape).astype(np.int64)
