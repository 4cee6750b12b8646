"""The parts that touch, told apart by their cores: what lies deeper in them than the contact does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Core:
    """A place that is deeper than all around it. cube: its number in the grid, C order. depth_mm: there. pass_mm: depth of
    the deepest way from it to a core that is deeper; 0 if there is none inside of the box. pass_cube: the shallowest
    place of that way."""

    cube: int
    depth_mm: float
    pass_mm: float
    pass_cube: int

    @property
    def narrowing(self) -> float:
        """How narrow the pass is, as share of the depth of the core."""
        return self.pass_mm / self.depth_mm


def find_cores(depth: Floats, least_rise_mm: float) -> tuple[Core, ...]:
    """Cores that rise above their pass by least_rise_mm, the deepest first.

    depth: (X, Y, Z) mm, 0 outside of the body. Source: merge tree of the superlevel sets, by union and find over cubes in
    the order of their depth."""
    flat = depth.ravel()
    inside = np.flatnonzero(flat > 0.0)
    order = inside[np.argsort(-flat[inside], kind="stable")]
    peaks, passes = _merge(order, flat, np.array(depth.shape))
    cores = [
        Core(int(peak), float(flat[peak]), float(flat[at]) if at >= 0 else 0.0, int(at))
        for peak, at in zip(peaks, passes, strict=True)
    ]
    risen = [core for core in cores if core.depth_mm - core.pass_mm >= least_rise_mm]
    return tuple(sorted(risen, key=lambda core: (-core.depth_mm, core.cube)))


@njit(cache=True, nogil=True)
def _merge(order: Ints, depth: Floats, shape: Ints) -> tuple[Ints, Ints]:
    """Peaks (K,) and the cubes where they meet a higher one (K,), -1 if they never do."""
    parent = np.full(len(depth), -1, dtype=np.int64)
    pass_of = np.full(len(depth), -1, dtype=np.int64)
    is_peak = np.zeros(len(depth), dtype=np.bool_)
    strides = (shape[1] * shape[2], shape[2], 1)
    for cube in order:
        parent[cube] = cube
        joined = -1  # root of the highest component next to the cube
        place = (cube // strides[0], cube // strides[1] % shape[1], cube % shape[2])
        for axis in range(3):
            for way in (-1, 1):
                if not 0 <= place[axis] + way < shape[axis]:
                    continue
                beside = cube + way * strides[axis]
                if parent[beside] < 0:
                    continue
                root = beside
                while parent[root] != root:
                    parent[root] = parent[parent[root]]
                    root = parent[root]
                if joined < 0:
                    joined = root
                elif root != joined:
                    # a root is the first, so the deepest, of its component
                    higher = depth[root] > depth[joined] or (depth[root] == depth[joined] and root < joined)
                    lower = joined if higher else root
                    joined = root if higher else joined
                    parent[lower] = joined
                    pass_of[lower] = cube
        if joined < 0:
            is_peak[cube] = True
        else:
            parent[cube] = joined
    peaks = np.flatnonzero(is_peak)
    return peaks, pass_of[peaks]
