"""Tetrahedra between surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Mesher = Literal["tetgen", "gmsh"]


@dataclass(frozen=True, eq=False, slots=True)
class VolumeMesh:
    """Conforming tetrahedra: two that meet share a whole face, edge or corner.

    vertices: (V, 3) mm, those of the surfaces first, in their order. tetrahedra: (T, 4) int32, right-handed: the fourth corner
    lies where the normal of the first three points. region: (T,) int32, number of the surface whose tissue each belongs to.
    mesher: who made them.
    """

    vertices: NDArray[np.float64]
    tetrahedra: NDArray[np.int32]
    region: NDArray[np.int32]
    mesher: Mesher

    def corners(self) -> NDArray[np.float64]:
        """(T, 4, 3) mm."""
        return self.vertices[self.tetrahedra]
