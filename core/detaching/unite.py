"""Parts that run through each other without being grown together, united so that there is a contact to open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.exact_intersection import find_intersecting_faces
from core.healing.heal import heal
from core.healing.intersections.resolve import unite_overlaps
from core.mesh import Mesh
from core.run import RunContext
from core.schema.heal import HealParameters

UNITING = HealParameters(max_volume_change=0.5, max_area_change=0.5, max_deviation_mm=1000.0)
"""Of what the union leaves, such as cavities: a skin is one surface."""


@dataclass(frozen=True, eq=False, slots=True)
class United:
    """mesh: free of self-intersection. crossing: pairs of faces (K, 2) of the skin as it came that crossed each other."""

    mesh: Mesh
    crossing: NDArray[np.int64]


def unite(skin: Mesh, run: RunContext) -> United:
    """The outer surface of a skin whose parts run through each other.

    Needs:    closed, manifold, outward, exact in float32.
    Promises: free of self-intersection (exact); faces away from where it crossed itself stay, bit for bit; a skin that crosses
              itself nowhere comes back as it is.
    Raises:   InputError `heal.*` if it cannot be united.
    """
    crossing = find_intersecting_faces(skin.vertices, skin.faces)
    if not len(crossing):
        return United(skin, crossing)
    vertices, faces = unite_overlaps(skin.vertices, skin.faces)
    used, numbered = np.unique(faces, return_inverse=True)
    healed = heal(Mesh.of(vertices[used], numbered.reshape(-1, 3)), UNITING, run)
    run.log(f"{len(crossing):,} pairs of faces crossed each other: the parts were united before they are set apart")
    return United(healed.mesh, crossing)
