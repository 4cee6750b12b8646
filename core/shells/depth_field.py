"""How deep each layer should lie below each skin vertex."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.adjacency import Rows
from core.mesh import Vertices
from core.schema.shells import Layer, Region
from core.shells.depth_arrays import require_depths, require_inwards

Floats = NDArray[np.float64]


NO_ARRAYS: Mapping[str, Floats] = {}


def target_depths(
    vertices: Vertices, layers: tuple[Layer, ...], regions: tuple[Region, ...], arrays: Mapping[str, Floats] = NO_ARRAYS
) -> Floats:
    """Distance to the skin asked for, (L, V) mm: the layers' own, blended smoothly into each region's across its blend width.

    arrays: name -> (V,) mm, for layers that have a depth of their own at each vertex.
    Raises: InputError `region.outside_mesh`, `region.overlap_conflict`, `layer.array_missing`, `layer.array_out_of_range`,
    `layer.depths_out_of_order`.
    """
    _require_regions_agree(regions)
    depths = np.empty((len(layers), len(vertices)))
    for row, layer in enumerate(layers):
        depths[row] = layer.depth_mm if layer.depth_array is None else require_depths(layer, arrays, vertices)
    for region in regions:
        weight = _region_weight(vertices, region)
        if not (weight == 1.0).any():
            low, high = vertices.min(axis=0), vertices.max(axis=0)
            raise InputError(
                "region.outside_mesh",
                f"no vertex of the skin lies in region '{region.name}'; the skin spans {np.round(low, 1).tolist()} to "
                f"{np.round(high, 1).tolist()} mm",
                region=region.name,
            )
        for row, layer in enumerate(layers):
            if layer.name in region.depths_mm:
                depths[row] += weight * (region.depths_mm[layer.name] - depths[row])
    require_inwards(layers, depths, vertices)
    return depths


def _region_weight(vertices: Vertices, region: Region) -> Floats:
    """1 inside the box, falling with a smooth step to 0 at `blend_mm` from it, (V,)."""
    low, high = np.array(region.box_mm.min), np.array(region.box_mm.max)
    outside = np.maximum(np.maximum(low - vertices, vertices - high), 0.0)
    distance = np.sqrt((outside**2).sum(axis=1))
    if region.blend_mm == 0:
        return np.where(distance == 0, 1.0, 0.0)
    share = np.clip(1 - distance / region.blend_mm, 0.0, 1.0)
    weight: Floats = share * share * (3 - 2 * share)
    return weight


def _require_regions_agree(regions: tuple[Region, ...]) -> None:
    for a, b in combinations(regions, 2):
        apart = any(a.box_mm.max[axis] < b.box_mm.min[axis] or b.box_mm.max[axis] < a.box_mm.min[axis] for axis in range(3))
        if not apart and a.depths_mm != b.depths_mm:
            raise InputError(
                "region.overlap_conflict",
                f"regions '{a.name}' and '{b.name}' overlap but ask for different depths: {a.depths_mm} and {b.depths_mm} mm",
                first=a.name,
                second=b.name,
            )


def limit_slope(values: Floats, vertices: Vertices, neighbours: Rows, slope: float) -> Floats:
    """Largest field below `values` (V,) that changes along no edge by more than slope x length; O(V log V) in practice."""
    limited = values.copy()
    _spread(vertices, neighbours.start, neighbours.values, slope, np.argsort(values, kind="stable"), limited)
    return limited


@njit(cache=True, nogil=True)
def _spread(
    vertices: Floats,
    start: NDArray[np.int64],
    values: NDArray[np.int32],
    slope: float,
    order: NDArray[np.int64],
    limited: Floats,
) -> None:
    """Label-correcting sweep: low values first, then whatever they lowered, until nothing changes."""
    count = len(limited)
    queue = np.empty(count, np.int64)
    queue[:] = order
    queued = np.ones(count, np.bool_)
    head, waiting = 0, count
    while waiting > 0:
        vertex = queue[head]
        head = (head + 1) % count
        waiting -= 1
        queued[vertex] = False
        for i in range(start[vertex], start[vertex + 1]):
            other = values[i]
            length = 0.0
            for axis in range(3):
                length += (vertices[vertex, axis] - vertices[other, axis]) ** 2
            bound = limited[vertex] + slope * np.sqrt(length)
            if bound < limited[other]:
                limited[other] = bound
                if not queued[other]:
                    queued[other] = True
                    queue[(head + waiting) % count] = other
                    waiting += 1
