"""A field on the triangles of a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class MappedField:
    """values: (F, 3) vectors or (F, 1) magnitudes in V/m, NaN for a triangle too far from the field. distance_mm: (F,) from the
    triangle to the place its value was taken from. method: in words, for the report."""

    values: Floats
    distance_mm: Floats
    method: str

    @property
    def is_vector(self) -> bool:
        """False if only magnitudes are known."""
        return bool(self.values.shape[1] == 3)

    @property
    def magnitude(self) -> Floats:
        """Length of the vector, or the magnitude itself, (F,)."""
        lengths: Floats = np.linalg.norm(self.values, axis=1) if self.is_vector else self.values[:, 0]
        return lengths

    @property
    def too_far(self) -> NDArray[np.bool_]:
        """Triangles without a value, (F,)."""
        missing: NDArray[np.bool_] = np.isnan(self.values[:, 0])
        return missing
