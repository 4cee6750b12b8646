"""A field and surfaces that are nowhere near each other, most often for their units."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.mesh import Mesh

Floats = NDArray[np.float64]
FACTORS = {1000.0: "m", 10.0: "cm", 25.4: "inches", 0.001: "mm where m was said", 0.1: "mm where cm was said"}
ALIKE = 0.25  # share of their size by which boxes that belong together may differ


def no_overlap(surfaces: Iterable[Mesh], places: Floats, limit_mm: float) -> InputError:
    """What to raise if no triangle of any surface is within the limit of the field's places (N, 3) mm."""
    corners = np.concatenate([surface.vertices for surface in surfaces])
    field_box, surface_box = _box(places), _box(corners)
    hint = next(
        (
            f"; if the field is in {unit}, upload it with that unit"
            for factor, unit in FACTORS.items()
            if _alike(factor * field_box, surface_box)
        ),
        "; are both in the same coordinates?",
    )
    return InputError(
        "fields.no_overlap",
        f"no triangle is within {limit_mm:g} mm of the field, which lies in {_said(field_box)} mm; the surfaces lie in "
        f"{_said(surface_box)} mm{hint}",
        field_extent_mm=float(np.ptp(field_box, axis=0).max()),
        surfaces_extent_mm=float(np.ptp(surface_box, axis=0).max()),
    )


def _box(points: Floats) -> Floats:
    """Lowest and highest corner, (2, 3)."""
    box: Floats = np.stack([points.min(axis=0), points.max(axis=0)])
    return box


def _alike(one: Floats, other: Floats) -> bool:
    size = float(np.ptp(other, axis=0).max())
    return bool(np.abs(one - other).max() <= ALIKE * size)


def _said(box: Floats) -> str:
    return ", ".join(f"{axis} {low:.4g} to {high:.4g}" for axis, low, high in zip("xyz", *box, strict=True))
