"""The surface a band follows: from that of the base to that of the donor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.distance import closest_points_in
from core.geometry.face_tree import FaceTree

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Transition:
    """base, donor: the whole surfaces. base_rim, donor_rim: (N, 3) and (M, 3) mm. Beyond reach_mm nothing is drawn near."""

    base: FaceTree
    donor: FaceTree
    base_rim: Floats
    donor_rim: Floats
    reach_mm: float

    def draw(self, points: Floats) -> Floats:
        """Places for points (N, 3) between the two surfaces: halfway between the rims they are halfway between the surfaces."""
        to_base, to_donor = (nearest_distance(cKDTree(rim), points) for rim in (self.base_rim, self.donor_rim))
        share = (to_base / (to_base + to_donor))[:, None]
        base_distance, on_base, _ = closest_points_in(self.base, points)
        donor_distance, on_donor, _ = closest_points_in(self.donor, points)
        near = np.maximum(base_distance, donor_distance) <= self.reach_mm
        return np.where(near[:, None], (1.0 - share) * on_base + share * on_donor, points)


def nearest_distance(tree: cKDTree, points: Floats) -> Floats:
    """Distance from points (N, 3) to the nearest point of the tree, (N,)."""
    distance: Floats = np.asarray(tree.query(points)[0])
    return distance
