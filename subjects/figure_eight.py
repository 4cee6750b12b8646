"""A figure-of-eight coil for tests: rings of magnetic dipoles by formula, and the primary field they induce in closed form."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.coil import Coil

Floats = NDArray[np.float64]
MU0_OVER_4PI = 1e-7  # T·m/A
RADII_MM = (10.0, 20.0, 30.0)
AWAY_MM = 35.0  # of the middle of each wing from the middle of the coil
MOMENT_A_M2 = 0.01  # of each dipole, at 1 A


def figure_eight(per_ring: int = 24) -> Coil:
    """Two discs of dipoles in the plane z = 0, wings along x, up in one and down in the other."""
    turns = 2.0 * np.pi * np.arange(per_ring) / per_ring
    ring = np.column_stack([np.cos(turns), np.sin(turns), np.zeros(per_ring)])
    wing = np.concatenate([radius * ring for radius in RADII_MM])
    shift = np.array([AWAY_MM, 0.0, 0.0])
    up = np.tile([0.0, 0.0, MOMENT_A_M2], (len(wing), 1))
    return Coil.of(np.concatenate([wing - shift, wing + shift]), np.concatenate([up, -up]))


def above_head(highest: Floats, gap_mm: float = 6.0) -> Floats:
    """Placement (4, 4) mm: the coil level, `gap_mm` above the highest point (3,) of a head."""
    placement = np.eye(4)
    placement[:3, 3] = highest + np.array([0.0, 0.0, gap_mm])
    return placement


def primary_field(coil: Coil, points: Floats, didt_a_per_s: float = 1e6) -> Floats:
    """E = -dA/dt (N, 3) in V/m at points (N, 3) mm, of dipoles whose moments are those at 1 A, A = mu0/4pi * m x r / r^3."""
    field = np.zeros_like(points)
    for place, moment in zip(coil.positions, coil.moments, strict=True):
        apart = (points - place) / 1000.0
        field -= np.cross(moment, apart) / np.linalg.norm(apart, axis=1)[:, None] ** 3
    return MU0_OVER_4PI * didt_a_per_s * field


def write_ccd(coil: Coil, path: Path, header: str = "dIdtmax=100e6;") -> None:
    """The dipoles as a .ccd file: metres and A·m²."""
    rows = np.column_stack([coil.positions / 1000.0, coil.moments])
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"# made by formula; {header}\n{len(rows)}\n# places and moments of the dipoles\n")
        np.savetxt(file, rows, fmt="%.9e")
