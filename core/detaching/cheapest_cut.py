"""The smallest surface that separates two cores inside of the body: a minimal cut through the contact."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, label

from core.detaching.cores import Core
from core.detaching.creases import Creases
from core.detaching.graph_cut import SINK, SOURCE, cut_in_two

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

SEED_LEVEL = 0.3  # of the way from the pass up to the core: what is deeper belongs to the part
NEARER_SHARE = 0.8  # of the way to the other part's seeds: what is nearer than that to the seeds of a part belongs to it, too
# of links along axes, diagonals of sides and of cubes: a plane cut costs nearly its area, whichever way it looks
COSTS = (137, 78, 61)
SIDE_COST = COSTS[0] + 4 * COSTS[1] + 4 * COSTS[2]  # of a plane cut per side of a cube
TIE_COST = 2 * SIDE_COST  # of a cube under the skin that is on another side of the cut than the face above it


def find_seeds(depth: Floats, core: Core, others: tuple[Core, ...], size_mm: float) -> NDArray[np.int8]:
    """What surely belongs to the part of a core, 1, and to that of others, 2; (X, Y, Z), 0 elsewhere.

    depth: (X, Y, Z) mm, 0 outside of what is to be cut. What is as deep as a seed has a ball around it within the body: seeds
    grow by that, as far as the other part leaves them. Small ones would be cut out of their own part: that costs less."""
    seeds = np.zeros(depth.shape, dtype=np.int8)
    level = core.pass_mm + SEED_LEVEL * (core.depth_mm - core.pass_mm)
    pieces, _count = label(depth > level)
    flat = pieces.ravel()
    for other in others:
        if flat[other.cube] > 0:
            seeds[pieces == flat[other.cube]] = 2
    seeds[pieces == flat[core.cube]] = 1
    if not (seeds == 2).any():
        return seeds
    first, second = (distance_transform_edt(seeds != part) * size_mm for part in (1, 2))
    grown = np.where(first < np.minimum(level, NEARER_SHARE * second), 1, 0)
    grown = np.where(second < np.minimum(level, NEARER_SHARE * first), 2, grown)
    return np.where(depth > 0.0, grown, 0).astype(np.int8)


def find_least_cut(solid: Flags, seeds: NDArray[np.int8], creases: Creases, border_mm: float, size_mm: float) -> NDArray[np.int8]:
    """1 and 2 for the sides of the cheapest surface between the seeds, 0 outside of the body; all (X, Y, Z).

    It costs its area, and border_mm for each mm of its border that runs over flat skin and not along a crease: where parts are
    sunk deep into each other the surface of least area alone would rather cut the thinner one off.
    Source: Boykov & Kolmogorov 2003, doi:10.1109/ICCV.2003.1238310."""
    number = np.full(solid.shape, -1, dtype=np.int64)
    free = solid & (seeds == 0)
    number[free] = 2 + np.arange(int(free.sum()))
    number[seeds == 1], number[seeds == 2] = SOURCE, SINK
    first, second, cost = [], [], []
    for way, share in _ways():
        here, there = _shifted(number, way)
        linked = (here >= 0) & (there >= 0) & (here != there)
        first.append(here[linked])
        second.append(there[linked])
        cost.append(np.full(int(linked.sum()), share))
    count = 2 + int(free.sum())
    flat = number.ravel()
    tied = flat[creases.cubes] >= 0
    first += [flat[creases.cubes[tied]], count + creases.pairs[:, 0]]
    second += [count + creases.nearest[tied], count + creases.pairs[:, 1]]
    per_mm = border_mm * SIDE_COST / size_mm**2
    cost += [np.full(int(tied.sum()), TIE_COST), np.maximum((per_mm * creases.cost_mm).astype(np.int64), 1)]
    count += len(creases.faces)
    reached = cut_in_two(count, np.concatenate(first), np.concatenate(second), np.concatenate(cost))
    side = np.zeros(solid.shape, dtype=np.int8)
    side[solid] = np.where(reached[number[solid]], 1, 2)
    return side


def _ways() -> list[tuple[tuple[int, int, int], int]]:
    """Half of the 26 directions with their shares."""
    steps = (-1, 0, 1)
    ways = ((x, y, z) for x in steps for y in steps for z in steps)
    return [(way, COSTS[sum(map(abs, way)) - 1]) for way in ways if way > (0, 0, 0)]


def _shifted(number: Ints, way: tuple[int, int, int]) -> tuple[Ints, Ints]:
    here = tuple(slice(max(-step, 0), size - max(step, 0)) for step, size in zip(way, number.shape, strict=True))
    there = tuple(slice(max(step, 0), size + min(step, 0)) for step, size in zip(way, number.shape, strict=True))
    return number[here], number[there]
