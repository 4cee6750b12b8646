"""What each iteration did to a surface, in numbers."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.quality import quality
from core.mesh import Faces, Vertices

LOW_PERCENTILE = 1.0


@dataclass(frozen=True, slots=True)
class Progress:
    """A surface after an iteration; number 0 is before the first.

    Qualities q are those of the faces around vertices that may move, area and volume those of the whole surface.
    volume_mm3: None for an open surface. largest_shift_mm: farthest way of a vertex from its original place.
    shortened, held: vertices whose step was cut short, or refused, to keep the surface sound.
    """

    iteration: int
    lowest_quality: float
    low_percentile_quality: float
    mean_quality: float
    area_mm2: float
    volume_mm3: float | None
    largest_shift_mm: float
    moved: int
    shortened: int
    held: int
    flipped: int


def measure_progress(
    iteration: int,
    vertices: Vertices,
    original: Vertices,
    faces: Faces,
    asked: NDArray[np.int64],
    *,
    closed: bool,
    moved: int = 0,
    shortened: int = 0,
    held: int = 0,
    flipped: int = 0,
) -> Progress:
    """asked: (K,) the faces whose quality counts; faces (F, 3), vertices and original (V, 3) mm."""
    q = quality(vertices, faces[asked])
    area, volume = _area_and_volume(vertices, faces, vertices.mean(axis=0))
    shift = vertices - original
    return Progress(
        iteration=iteration,
        lowest_quality=float(q.min(initial=1.0)),
        low_percentile_quality=float(np.percentile(q, LOW_PERCENTILE)) if len(q) else 1.0,
        mean_quality=float(q.mean()) if len(q) else 1.0,
        area_mm2=area,
        volume_mm3=volume if closed else None,
        largest_shift_mm=float(np.sqrt(np.einsum("ij,ij->i", shift, shift).max())),
        moved=moved,
        shortened=shortened,
        held=held,
        flipped=flipped,
    )


@njit(cache=True, nogil=True)
def _area_and_volume(vertices: Vertices, faces: Faces, middle: NDArray[np.float64]) -> tuple[float, float]:
    """Sum of the areas, and of the tetrahedra over the faces from the middle (3,), where no digits cancel."""
    area, volume = 0.0, 0.0
    for face in range(len(faces)):
        a, b, c = faces[face, 0], faces[face, 1], faces[face, 2]
        ax, ay, az = vertices[a, 0] - middle[0], vertices[a, 1] - middle[1], vertices[a, 2] - middle[2]
        ux, uy, uz = vertices[b, 0] - vertices[a, 0], vertices[b, 1] - vertices[a, 1], vertices[b, 2] - vertices[a, 2]
        vx, vy, vz = vertices[c, 0] - vertices[a, 0], vertices[c, 1] - vertices[a, 1], vertices[c, 2] - vertices[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        area += 0.5 * math.sqrt(nx * nx + ny * ny + nz * nz)
        volume += (ax * nx + ay * ny + az * nz) / 6.0
    return area, volume
