"""A coil as magnetic dipoles and pieces of wire: where they are and how strong. Frozen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import InputError

Floats = NDArray[np.float64]
SMALLEST_MM, LARGEST_MM = 5.0, 1000.0  # a coil for mice, and a helmet around the largest head


@dataclass(frozen=True, eq=False, slots=True)
class Coil:
    """Dipoles at `positions` (N, 3) mm with `moments` (N, 3) A·m², and pieces of wire around `wire` (M, 3) mm along
    `wire_along` (M, 3) mm; N + M >= 1. Arrays are read-only."""

    positions: Floats
    moments: Floats
    wire: Floats
    wire_along: Floats

    @classmethod
    def of(cls, positions: ArrayLike, moments: ArrayLike, wire: ArrayLike = (), wire_along: ArrayLike = ()) -> Coil:
        """Check and freeze.

        Raises: InputError `coil.no_dipoles`, `coil.not_finite`, `coil.size` with a hint at the unit.
        """
        arrays = [np.array(rows, dtype=np.float64, order="C").reshape(-1, 3) for rows in (positions, moments, wire, wire_along)]
        coil = cls(*arrays)
        if not len(coil.positions) and not len(coil.wire):
            raise InputError("coil.no_dipoles", "the coil has neither dipoles nor pieces of wire")
        bad = sum(int((~np.isfinite(rows)).any(axis=1).sum()) for rows in arrays)
        if bad:
            raise InputError("coil.not_finite", f"{bad} rows of the coil have numbers that are NaN or infinite", count=bad)
        _require_size(coil.places())
        for rows in arrays:
            rows.setflags(write=False)
        return coil

    def places(self) -> Floats:
        """Of all dipoles and pieces of wire, (N + M, 3) mm."""
        return np.concatenate([self.positions, self.wire])

    def placed(self, placement: Floats) -> Coil:
        """Moved by a rigid (4, 4) placement in mm."""
        turn, shift = placement[:3, :3], placement[:3, 3]
        places = self.positions @ turn.T + shift
        return Coil.of(places, self.moments @ turn.T, self.wire @ turn.T + shift, self.wire_along @ turn.T)


def _require_size(places: Floats) -> None:
    """One dipole has no size and says nothing."""
    longest = float(np.ptp(places, axis=0).max())
    if len(places) == 1 or SMALLEST_MM <= longest <= LARGEST_MM:
        return
    factor = next((factor for factor in (1e-3, 1e3) if SMALLEST_MM <= longest * factor <= LARGEST_MM), None)
    hint = (
        ".ccd is in metres, .tcd in millimetres: it looks as if the file were in the other unit, "
        f"by which it would be {longest * factor:.4g} mm wide"
        if factor is not None
        else f"coils are {SMALLEST_MM:g} to {LARGEST_MM:g} mm wide"
    )
    raise InputError("coil.size", f"the coil is {longest:.4g} mm wide; {hint}", extent_mm=longest)
