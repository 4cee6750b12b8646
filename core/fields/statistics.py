"""A field on a surface in numbers; means and percentiles are by area."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.fields.mapped import MappedField
from core.geometry.normals import face_areas, face_normals
from core.mesh import Mesh
from core.schema.report import FieldNumbers, FieldReport

Floats = NDArray[np.float64]


def measure_field(surface: Mesh, mapped: MappedField) -> FieldReport:
    """Numbers of one surface; without a value anywhere there are none."""
    there = ~mapped.too_far
    areas = face_areas(surface.vertices, surface.faces)
    counts = {
        "faces": len(there),
        "too_far": int((~there).sum()),
        "area_with_value_mm2": float(areas[there].sum()),
        "farthest_mm": float(mapped.distance_mm.max()),
        "method": mapped.method,
    }
    if not there.any():
        return FieldReport(**counts)
    magnitude, weights = mapped.magnitude[there], areas[there]
    largest = int(np.flatnonzero(there)[np.argmax(magnitude)])
    x, y, z = surface.vertices[surface.faces[largest]].mean(axis=0)
    parts: dict[str, FieldNumbers] = {}
    if mapped.is_vector:
        normals, vectors = face_normals(surface.vertices, surface.faces)[there], mapped.values[there]
        along = np.einsum("nd,nd->n", vectors, normals)
        parts = {
            "normal": _numbers(np.abs(along), weights),
            "tangential": _numbers(np.linalg.norm(vectors - along[:, None] * normals, axis=1), weights),
        }
    return FieldReport(
        **counts,
        magnitude=_numbers(magnitude, weights),
        maximum_at_mm=(float(x), float(y), float(z)),
        maximum_face=largest + 1,
        **parts,
    )


def _numbers(values: Floats, weights: Floats) -> FieldNumbers:
    total = float(weights.sum())
    mean = float((values * weights).sum() / total) if total else float(values.mean())
    return FieldNumbers(mean=mean, percentile_99=_percentile(values, weights, 0.99), maximum=float(values.max()))


def _percentile(values: Floats, weights: Floats, share: float) -> float:
    """The smallest value that this share of the weight does not exceed."""
    order = np.argsort(values, kind="stable")
    sums = np.cumsum(weights[order])
    return float(values[order][min(int(np.searchsorted(sums, share * sums[-1])), len(values) - 1)])
