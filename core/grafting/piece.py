"""What one of the two meshes gives to the result: the faces on its side of the wall, and their rims."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.grafting.rim import find_rims, tidy
from core.grafting.wall import Box, wall_distance
from core.mesh import Mesh

Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Piece:
    """beyond_mm: (V,) how far each vertex of the whole mesh lies on the side that is taken. taken: (F,) tidy."""

    name: str
    mesh: Mesh
    beyond_mm: Floats
    taken: Flags

    @classmethod
    def cut(cls, name: str, mesh: Mesh, boxes: Sequence[Box], *, inside: bool, margin_mm: float) -> Piece:
        """The faces all of whose corners lie inside or outside of the boxes, at least `margin_mm` off the walls.

        Raises: InputError `region.outside_mesh` or `region.covers_mesh` if there is none.
        """
        beyond_mm = wall_distance(mesh.vertices, boxes) * (-1.0 if inside else 1.0)
        beyond = beyond_mm >= margin_mm
        taken = tidy(mesh.faces, np.all(beyond[mesh.faces], axis=1))
        if not taken.any():
            code, side = ("region.outside_mesh", "inside") if inside else ("region.covers_mesh", "outside of")
            raise InputError(code, f"nothing of the {name} lies {side} the region, {margin_mm:g} mm off its walls", mesh=name)
        return cls(name, mesh, beyond_mm, taken)

    @cached_property
    def rims(self) -> list[Ints]:
        """Vertex numbers along each rim."""
        return find_rims(self.mesh.faces[self.taken])

    def rim_points(self) -> list[Floats]:
        """Places along each rim, (N, 3) mm."""
        return [self.mesh.vertices[rim] for rim in self.rims]

    def without(self, vertices: Ints) -> Piece:
        """Less the faces around these vertices."""
        taken = self.taken & ~np.isin(self.mesh.faces, vertices).any(axis=1)
        return Piece(self.name, self.mesh, self.beyond_mm, tidy(self.mesh.faces, taken))

    def with_turned(self, rim: Ints, depth_mm: float) -> Piece | None:
        """The piece without a rim that only grazes the wall: the hole in it filled again, or the islet in it dropped.

        None if the faces there reach deeper than `depth_mm` beyond the wall, or have other rims as well.
        """
        for inside in (False, True):
            side = self.taken if inside else ~self.taken
            chosen = np.flatnonzero(side)
            label = face_components(edges(self.mesh.faces[chosen]))[1]
            at_rim = np.isin(self.mesh.faces[chosen], rim).sum(axis=1) >= 2
            for patch in np.unique(label[at_rim]):
                members = chosen[label == patch]
                corners = self.mesh.faces[members]
                reach = self.beyond_mm[corners].max() if inside else -self.beyond_mm[corners].min()
                patch_rims = find_rims(corners) if reach <= depth_mm else []
                if len(patch_rims) == 1 and set(patch_rims[0].tolist()) == set(rim.tolist()):
                    turned = self.taken.copy()
                    turned[members] = not inside
                    return Piece(self.name, self.mesh, self.beyond_mm, tidy(self.mesh.faces, turned))
        return None
