"""Where on a surface damage is done."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges, vertex_neighbours
from core.mesh import Mesh

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Generator = np.random.Generator


def some_faces(mesh: Mesh, generator: Generator, count: int) -> Ints:
    """Faces drawn at random, none of which shares a corner with another, (count,) or fewer, ascending."""
    used = np.zeros(len(mesh.vertices), dtype=bool)
    chosen = []
    for face in generator.permutation(len(mesh.faces)):
        corners = mesh.faces[face]
        if not used[corners].any():
            used[corners] = True
            chosen.append(face)
            if len(chosen) == count:
                break
    return np.sort(np.array(chosen, dtype=np.int64))


def some_vertices(mesh: Mesh, generator: Generator, count: int, rings: int) -> Ints:
    """Vertices drawn at random, more than `2 rings + 1` edges from each other, (count,) or fewer."""
    taken = np.zeros(len(mesh.vertices), dtype=bool)
    chosen = []
    for vertex in generator.permutation(np.unique(mesh.faces)):
        ball = rings_around(mesh, [int(vertex)], 2 * rings + 1)
        if not taken[ball].any():
            taken[vertex] = True
            chosen.append(int(vertex))
            if len(chosen) == count:
                break
    return np.array(chosen, dtype=np.int64)


def rings_around(mesh: Mesh, vertices: list[int], rings: int) -> Flags:
    """Vertices (V,) within some edges of the given ones."""
    found = np.zeros(len(mesh.vertices), dtype=bool)
    found[vertices] = True
    for _ in range(rings):
        touched = mesh.faces[found[mesh.faces].any(axis=1)]
        found[touched] = True
    return found


def near(mesh: Mesh, point: Floats, radius_mm: float) -> Flags:
    """Vertices (V,) that hang together with the one nearest to the point inside a ball of the radius around it."""
    distance = np.linalg.norm(mesh.vertices - mesh.vertices[nearest_vertex(mesh, point)], axis=1)
    inside = distance <= radius_mm
    found = np.zeros(len(mesh.vertices), dtype=bool)
    found[distance.argmin()] = True
    around = vertex_neighbours(edges(mesh.faces).ends, len(mesh.vertices))
    front = [int(distance.argmin())]
    while front:
        reached = around[front.pop()]
        fresh = reached[inside[reached] & ~found[reached]]
        found[fresh] = True
        front.extend(fresh.tolist())
    return found


def nearest_vertex(mesh: Mesh, point: Floats) -> int:
    """The vertex nearest to a point (3,)."""
    return int(np.linalg.norm(mesh.vertices - point, axis=1).argmin())


def extreme(mesh: Mesh, direction: tuple[float, float, float]) -> Floats:
    """The vertex farthest in a direction, (3,) mm."""
    place: Floats = mesh.vertices[int((mesh.vertices @ np.array(direction)).argmax())]
    return place


def usual_edge(mesh: Mesh) -> float:
    """Median length of the edges, mm."""
    ends = edges(mesh.faces).ends
    return float(np.median(np.linalg.norm(mesh.vertices[ends[:, 0]] - mesh.vertices[ends[:, 1]], axis=1)))
