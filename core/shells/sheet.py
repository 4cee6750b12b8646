"""One layer in the making: its connectivity apart from its places, and where each vertex comes from on the skin."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.geometry.connectivity import Connectivity
from core.mesh import Faces, Vertices

Ints = NDArray[np.int64]


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

    def parts(self) -> tuple[Vertices, Faces, Ints, Ints]:
        """All that `of_parts` needs to make it again."""
        return self.vertices, self.net.faces, self.origin, self.stand_in

    @classmethod
    def of_parts(cls, vertices: Vertices, faces: Faces, origin: Ints, stand_in: Ints) -> Sheet:
        """The inverse of `parts`."""
        return cls(vertices, Connectivity.of(faces, len(vertices)), origin, stand_in)

    def at(self, vertices: Vertices) -> Sheet:
        """The same connectivity elsewhere."""
        return replace(self, vertices=vertices)

    def merged(self, gone: Ints, kept: Ints, places: Vertices) -> tuple[Sheet, Ints]:
        """Edges (gone[i], kept[i]) collapsed, no two of them in touch; the kept vertices stand at `places` (K, 3).

        Every edge must have passed the link condition, so the surface stays a closed manifold of the same genus.
        Returns the sheet and the old number of each of its faces.
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
        merged = Sheet(
            vertices[alive],
            Connectivity.of(number[faces[whole]].astype(np.int32), int(alive.sum())),
            self.origin[alive],
            number[target[self.stand_in]],
        )
        return merged, np.flatnonzero(whole)
