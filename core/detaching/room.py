"""Where a slit may run: off the walls of the box and off faces that reach through them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.detaching.spread import spread_over
from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

MARGIN = 1.25  # times the width


@dataclass(frozen=True, eq=False, slots=True)
class Room:
    """still: faces that must stay as they are, None if there are none. low, high: (3,) mm. margin_mm: to both."""

    still: FaceTree | None
    low: Floats
    high: Floats
    margin_mm: float

    @classmethod
    def of(cls, mesh: Mesh, may_change: Flags, low: Floats, high: Floats, width_mm: float) -> Room:
        """may_change: (F,) faces of the mesh."""
        still = None if may_change.all() else FaceTree.of(mesh.vertices, mesh.faces[~may_change])
        return cls(still, low, high, MARGIN * width_mm)

    def holds(self, points: Floats, faces: Ints) -> Flags:
        """True for faces (F,) of a sheet whose slit stays off everything that must not change."""
        places = spread_over(points, faces)
        fits = np.asarray(((places > self.low + self.margin_mm) & (places < self.high - self.margin_mm)).all(axis=1))
        if self.still is not None:
            fits = fits & (closest_points_in(self.still, places)[0] > self.margin_mm)
        return np.asarray(fits.reshape(len(faces), -1).all(axis=1))
