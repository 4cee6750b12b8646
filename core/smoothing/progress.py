"""What each iteration did to a surface, in numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import face_areas
from core.geometry.quality import quality
from core.geometry.volume import signed_volumes
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
    volume = float(signed_volumes(vertices, faces, np.zeros(len(faces), dtype=np.int64))[0]) if closed else None
    shift = vertices - original
    return Progress(
        iteration=iteration,
        lowest_quality=float(q.min(initial=1.0)),
        low_percentile_quality=float(np.percentile(q, LOW_PERCENTILE)) if len(q) else 1.0,
        mean_quality=float(q.mean()) if len(q) else 1.0,
        area_mm2=float(face_areas(vertices, faces).sum()),
        volume_mm3=volume,
        largest_shift_mm=float(np.sqrt(np.einsum("ij,ij->i", shift, shift).max())),
        moved=moved,
        shortened=shortened,
        held=held,
        flipped=flipped,
    )
