"""Which vertices smoothing may move."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.adjacency import edges
from core.mesh import Mesh
from core.schema.smooth import SmoothRegion

Flags = NDArray[np.bool_]


def is_in_regions(mesh: Mesh, regions: tuple[SmoothRegion, ...]) -> Flags:
    """Vertices (V,) in one of the boxes, walls included; all of them if there are no regions."""
    if not regions:
        return np.ones(len(mesh.vertices), dtype=np.bool_)
    inside: Flags = np.logical_or.reduce([_is_in(mesh, region) for region in regions])
    return inside


def is_free(mesh: Mesh) -> Flags:
    """Vertices (V,) with faces all the way round; the rims of an open surface and vertices without faces stay."""
    table = edges(mesh.faces)
    free = np.zeros(len(mesh.vertices), dtype=np.bool_)
    free[mesh.faces.ravel()] = True
    free[table.ends[table.face_count != 2].ravel()] = False
    return free


def require_regions(surfaces: Mapping[str, Mesh], regions: tuple[SmoothRegion, ...]) -> None:
    """Every box must hold a vertex of some surface. Raises: InputError `region.outside_mesh`."""
    for region in regions:
        if not any(_is_in(mesh, region).any() for mesh in surfaces.values()):
            low = np.min([mesh.vertices.min(axis=0) for mesh in surfaces.values()], axis=0)
            high = np.max([mesh.vertices.max(axis=0) for mesh in surfaces.values()], axis=0)
            raise InputError(
                "region.outside_mesh",
                f"no vertex lies in the box of region '{region.name}', from {_words(region.box_mm.min)} to "
                f"{_words(region.box_mm.max)} mm; {'the surfaces reach' if len(surfaces) > 1 else 'the surface reaches'} "
                f"from {_words(low)} to {_words(high)} mm",
                region=region.name,
            )


def _is_in(mesh: Mesh, region: SmoothRegion) -> Flags:
    low, high = np.array(region.box_mm.min), np.array(region.box_mm.max)
    inside: Flags = np.minimum(mesh.vertices - low, high - mesh.vertices).min(axis=1) >= 0.0
    return inside


def _words(point: tuple[float, float, float] | NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{float(value):.6g}" for value in point) + ")"
