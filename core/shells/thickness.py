"""How well a layer keeps its depth, by area."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import face_areas
from core.mesh import Mesh
from core.schema.report import ThicknessReport
from core.shells.nested_shells import ON_TARGET, Shell

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


def measure_thickness(shell: Shell, target_mm: float) -> ThicknessReport:
    """Shares of the layer's area on target, limited and missed; extremes and percentiles of the depth in mm."""
    areas = vertex_areas(shell.mesh)
    total = float(areas.sum())
    on_target, limited = is_on_target(shell), is_limited(shell)
    order = np.argsort(shell.depth_mm, kind="stable")
    ranks = np.cumsum(areas[order]) / total
    depths = shell.depth_mm[order]
    return ThicknessReport(
        target_mm=target_mm,
        on_target_area=_share(areas[on_target], total),
        limited_area=_share(areas[limited], total),
        missed_area=_share(areas[~on_target & ~limited], total),
        min_mm=round(float(depths[0]), 6),
        max_mm=round(float(depths[-1]), 6),
        percentiles_mm={
            str(p): round(float(depths[min(int(np.searchsorted(ranks, p / 100)), len(depths) - 1)]), 6) for p in PERCENTILES
        },
    )


def _share(areas: Floats, total: float) -> float:
    return min(round(float(areas.sum()) / total, 6), 1.0)
