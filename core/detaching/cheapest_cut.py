"""The smallest surface that separates two cores inside of the body: a minimal cut through the contact."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from core.detaching.cores import Core
from core.detaching.graph_cut import SINK, SOURCE, cut_in_two

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

SEED_LEVEL = 0.3  # of the way from the pass up to the core: what is deeper belongs to the part
# of links along axes, diagonals of sides and of cubes: a plane cut costs nearly its area, whichever way it looks
COSTS = (137, 78, 61)


def find_seeds(depth: Floats, core: Core, others: tuple[Core, ...]) -> NDArray[np.int8]:
    """What surely belongs to the part of a core, 1, and to that of others, 2; (X, Y, Z), 0 elsewhere.

    depth: (X, Y, Z) mm, 0 outside of what is to be cut."""
    seeds = np.zeros(depth.shape, dtype=np.int8)
    level = core.pass_mm + SEED_LEVEL * (core.depth_mm - core.pass_mm)
    pieces, _count = label(depth > level)
    flat = pieces.ravel()
    for other in others:
        if flat[other.cube] > 0:
            seeds[pieces == flat[other.cube]] = 2
    seeds[pieces == flat[core.cube]] = 1
    return seeds


def find_least_cut(solid: Flags, seeds: NDArray[np.int8]) -> NDArray[np.int8]:
    """1 and 2 for the sides of the surface of least area between the seeds, 0 outside of the body; all (X, Y, Z).

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
