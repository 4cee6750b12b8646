"""One layer in the making: its connectivity apart from its places, and where each vertex comes from on the skin."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Rows, edges, vertex_faces, vertex_neighbours
from core.mesh import Faces, Vertices

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Connectivity:
    """Which vertices and faces touch. faces: (F, 3). faces_around, neighbours: one list per vertex."""

    faces: Faces
    vertex_count: int
    faces_around: Rows
    neighbours: Rows

    @classmethod
    def of(cls, faces: Faces, vertex_count: int) -> Connectivity:
        """O(F log F)."""
        around = vertex_faces(faces, vertex_count)
        return cls(faces, vertex_count, around, vertex_neighbours(edges(faces).ends, vertex_count))

    def faces_of(self, vertices: Flags) -> Ints:
        """Numbers of the faces with a corner among the vertices (V,)."""
        return np.flatnonzero(vertices[self.faces].any(axis=1))

    def corners_of(self, faces: Ints) -> Flags:
        """The vertices of some faces, as flags (V,)."""
        flags = np.zeros(self.vertex_count, dtype=np.bool_)
        flags[self.faces[faces].ravel()] = True
        return flags

    def grown(self, vertices: Flags) -> Flags:
        """The vertices and their neighbours."""
        return self.corners_of(self.faces_of(vertices)) if vertices.any() else vertices


@dataclass(frozen=True, eq=False, slots=True)
class Sheet:
    """A surface that began as a copy of the skin.

    vertices: (N, 3) mm. origin: (N,) skin vertex each came from. stand_in: (V,) vertex that stands for each skin vertex;
    where edges were collapsed, several share one.
    """

    vertices: Vertices
    net: Connectivity
    origin: Ints
    stand_in: Ints

    @classmethod
    def copy_of(cls, vertices: Vertices, faces: Faces) -> Sheet:
        """The skin itself."""
        numbers = np.arange(len(vertices))
        return cls(vertices, Connectivity.of(faces, len(vertices)), numbers, numbers)

    def at(self, vertices: Vertices) -> Sheet:
        """The same connectivity elsewhere."""
        return replace(self, vertices=vertices)

    def merged(self, gone: Ints, kept: Ints, places: Vertices) -> Sheet:
        """Edges (gone[i], kept[i]) collapsed, no two of them in touch; the kept vertices stand at `places` (K, 3).

        Every edge must have passed the link condition, so the surface stays a closed manifold of the same genus.
        """
        target = np.arange(self.net.vertex_count)
        target[gone] = kept
        faces = target[self.net.faces]
        whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
        alive = np.ones(self.net.vertex_count, dtype=np.bool_)
        alive[gone] = False
        number = np.cumsum(alive) - 1
        vertices = self.vertices.copy()
        vertices[kept] = places
        return Sheet(
            vertices[alive],
            Connectivity.of(number[faces[whole]].astype(np.int32), int(alive.sum())),
            self.origin[alive],
            number[target[self.stand_in]],
        )
