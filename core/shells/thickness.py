"""How well a layer keeps its depth, by area."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import face_areas
from core.mesh import Mesh
from core.schema.report import ThicknessReport
from core.shells.nested_shells import Shell
from core.shells.room import ON_TARGET

Floats = NDArray[np.float64]

PERCENTILES = (1, 5, 25, 50, 75, 95, 99)


def vertex_areas(mesh: Mesh) -> Floats:
    """A third of the area of the faces around each vertex, (V,) mm²."""
    shares = np.repeat(face_areas(mesh.vertices, mesh.faces) / 3, 3)
    areas = np.zeros(len(mesh.vertices))
    np.add.at(areas, mesh.faces.ravel(), shares)
    return areas


def is_on_target(shell: Shell) -> NDArray[np.bool_]:
    """Vertices (V,) within 5 % of the depth asked for there."""
    close: NDArray[np.bool_] = np.abs(shell.depth_mm - shell.targets_mm) <= ON_TARGET * shell.targets_mm
    return close


def is_limited(shell: Shell) -> NDArray[np.bool_]:
    """Vertices (V,) off target where the reach, faded smoothly and shared between the layers, allows no more."""
    limited: NDArray[np.bool_] = ~is_on_target(shell) & (shell.allowed_mm < (1 - ON_TARGET) * shell.targets_mm)
    return limited


def measure_thickness(shell: Shell, target_mm: float | None, array: str | None = None) -> ThicknessReport:
    """Shares of the layer's area on target, limited and missed; extremes and percentiles of the depth in mm.

    Without a single target, as the depths come from an array, the one that half of the area asks for no more than stands for it.
    """
    areas = vertex_areas(shell.mesh)
    total = float(areas.sum())
    on_target, limited = is_on_target(shell), is_limited(shell)
    reached = percentiles(shell.depth_mm, areas)
    return ThicknessReport(
        side=shell.side,
        target_mm=percentiles(shell.targets_mm, areas)["50"] if target_mm is None else target_mm,
        target_array=array,
        on_target_area=_share(areas[on_target], total),
        limited_area=_share(areas[limited], total),
        missed_area=_share(areas[~on_target & ~limited], total),
        min_mm=round(float(shell.depth_mm.min()), 6),
        max_mm=round(float(shell.depth_mm.max()), 6),
        percentiles_mm=reached,
    )


def percentiles(values_mm: Floats, areas: Floats) -> dict[str, float]:
    """Value that the share of the area in the key does not exceed."""
    order = np.argsort(values_mm, kind="stable")
    ranks = np.cumsum(areas[order]) / areas.sum()
    sorted_mm = values_mm[order]
    return {str(p): round(float(sorted_mm[min(int(np.searchsorted(ranks, p / 100)), len(order) - 1)]), 6) for p in PERCENTILES}


def _share(areas: Floats, total: float) -> float:
    return min(round(float(areas.sum()) / total, 6), 1.0)
