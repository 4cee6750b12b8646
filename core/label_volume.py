"""The one label volume type: a number per voxel and where the voxels are, frozen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import InputError

Labels: TypeAlias = NDArray[np.uint16]
Affine: TypeAlias = NDArray[np.float64]

LARGEST_LABEL = 65_535
FLATTEST = 1e-6  # volume of a voxel as share of that of a box with its sides: below it the axes lie in a plane


@dataclass(frozen=True, eq=False, slots=True)
class LabelVolume:
    """Voxels (i, j, k), each with a label; 0 is what nobody labelled. Arrays are read-only.

    labels: (I, J, K) uint16. affine: (4, 4) float64 from (i, j, k, 1), the centre of a voxel, to (x, y, z, 1) in mm.
    """

    labels: Labels
    affine: Affine

    @classmethod
    def of(cls, labels: Labels, affine: ArrayLike) -> LabelVolume:
        """Check and freeze; a left-handed affine is as good as any.

        Raises: InputError `volume.one_voxel`, `volume.affine_singular`.
        """
        if labels.ndim != 3 or min(labels.shape) < 2:
            size = " x ".join(str(side) for side in labels.shape)
            raise InputError(
                "volume.one_voxel", f"the volume has {size} voxels; a surface around labels needs two or more along every axis"
            )
        frame = np.array(affine, dtype=np.float64)
        _require_invertible(frame)
        kept = np.ascontiguousarray(labels, dtype=np.uint16)
        kept.setflags(write=False)
        frame.setflags(write=False)
        return cls(kept, frame)

    def voxel_mm(self) -> NDArray[np.float64]:
        """Distances between the centres of neighbouring voxels along the three axes, (3,) mm."""
        sides: NDArray[np.float64] = np.linalg.norm(self.affine[:3, :3], axis=0)
        return sides

    def voxel_mm3(self) -> float:
        """Volume of a voxel."""
        return float(abs(np.linalg.det(self.affine[:3, :3])))

    def places_mm(self, voxels: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places (N, 3) in mm of fractional voxel numbers (N, 3)."""
        places: NDArray[np.float64] = voxels @ self.affine[:3, :3].T + self.affine[:3, 3]
        return places

    def counts(self) -> dict[int, int]:
        """Label -> voxels that have it, ascending, without 0."""
        numbers = np.bincount(self.labels.ravel())
        return {int(label): int(numbers[label]) for label in np.flatnonzero(numbers) if label}


def _require_invertible(affine: Affine) -> None:
    sides = np.linalg.norm(affine[:3, :3], axis=0)
    usable = np.isfinite(affine).all() and (sides > 0.0).all()
    if not usable or abs(np.linalg.det(affine[:3, :3])) < FLATTEST * sides.prod():
        rows = "; ".join(" ".join(f"{number:.4g}" for number in row) for row in affine[:3])
        raise InputError("volume.affine_singular", f"the affine ({rows}) does not place voxels in space: it cannot be inverted")
