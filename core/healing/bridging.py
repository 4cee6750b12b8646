"""Rims of different pieces that belong to one gap: islets in holes, and the two ends of a tube of which a ring is missing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LARGEST_SHARE = 0.9  # of the caps over both rims: a band with more area does not join them
MOST_PAIRS = 100_000  # of rims looked at, the best first


@dataclass(frozen=True, eq=False, slots=True)
class Gaps:
    """What has to be filled: rims (each (n,) vertices), those that were joined with a bridge visit its ends twice.

    turned: pieces whose faces have to be turned over, since they looked against the piece they are joined to.
    """

    rims: list[Ints]
    turned: Ints


def join_rims(vertices: Vertices, faces: Faces, loops: list[Ints], piece: Ints) -> Gaps:
    """Join rims of different pieces where the band between them is smaller than the caps over both.

    piece: (F,) of each face. Rims with the smallest band come first; a rim may be joined with several, as that of a hole with
    its islets.
    """
    piece_of_vertex = np.zeros(len(vertices), dtype=np.int64)
    piece_of_vertex[faces] = piece[:, None]
    owner = np.array([piece_of_vertex[loop[0]] for loop in loops])
    nothing = np.empty(0, dtype=np.int64)
    if len(np.unique(owner)) < 2:
        return Gaps(loops, nothing)
    group = np.arange(int(owner.max()) + 1)  # pieces that hang together by bridges
    flips = np.zeros(len(group), dtype=np.bool_)
    rims: list[Ints | None] = list(loops)
    rim_of = np.arange(len(loops))
    for _cost, i, j in _candidates(vertices, loops, owner):
        a, b = owner[i], owner[j]
        first, second = int(rim_of[i]), int(rim_of[j])
        if first == second:
            continue
        start, end, alike = _bridge(vertices, loops[i], loops[j])
        if alike != (flips[a] != flips[b]):  # both rims would run the same way: turn one group over
            if group[a] == group[b]:
                continue
            members = np.flatnonzero(group == group[b])
            flips[members] ^= True
            for k, rim in enumerate(rims):
                if rim is not None and owner_of(rim, piece_of_vertex) in members:
                    rims[k] = rim[::-1]
        group[group == group[b]] = group[a]
        one, other = rims[first], rims[second]
        if one is None or other is None:
            raise ValueError("a rim was joined twice")
        one, other = _from(one, start), _from(other, end)
        rims[first] = np.concatenate((one, one[:1], other, other[:1]))
        rims[second] = None
        rim_of[rim_of == second] = first
    return Gaps([rim for rim in rims if rim is not None], np.flatnonzero(flips))


def find_partners(vertices: Vertices, loops: list[Ints], owner: Ints) -> Ints:
    """Pieces (K, 2) whose rims belong together; owner: (loops,) the piece of each rim."""
    if len(np.unique(owner)) < 2:
        return np.empty((0, 2), dtype=np.int64)
    return np.array([(owner[i], owner[j]) for _share, i, j in _candidates(vertices, loops, owner)], dtype=np.int64).reshape(-1, 2)


def owner_of(rim: Ints, piece_of_vertex: Ints) -> int:
    """The piece a rim lies on."""
    return int(piece_of_vertex[rim[0]])


def _from(rim: Ints, vertex: int) -> Ints:
    """The rim beginning at a vertex."""
    return np.roll(rim, -int(np.flatnonzero(rim == vertex)[0]))


def _candidates(vertices: Vertices, loops: list[Ints], owner: Ints) -> list[tuple[float, int, int]]:
    """Pairs of rims whose band is smaller than their caps: (share of the caps, rim, rim), best first."""
    number = np.repeat(np.arange(len(loops)), [len(loop) for loop in loops])
    points = vertices[np.concatenate(loops)]
    length = np.array(
        [np.linalg.norm(np.diff(vertices[loop], axis=0, append=vertices[loop[:1]]), axis=1).sum() for loop in loops]
    )
    cap = np.array([_cap_area(vertices[loop]) for loop in loops])
    trees = [cKDTree(vertices[loop]) for loop in loops]
    low = np.array([vertices[loop].min(axis=0) for loop in loops])
    high = np.array([vertices[loop].max(axis=0) for loop in loops])
    found = []
    for i in range(len(loops)):
        # a rim farther away than its caps are wide cannot pay
        apart = np.linalg.norm(np.maximum(0.0, np.maximum(low[i] - high, low - high[i])), axis=1)
        near = np.flatnonzero((apart * (length[i] + length) / 2 < cap[i] + cap) & (owner != owner[i]))
        for j in near[near > i].tolist():
            if np.intersect1d(loops[i], loops[j]).size:
                continue  # rims that touch have no band between them
            there, back = trees[j].query(points[number == i])[0], trees[i].query(points[number == j])[0]
            way = (np.mean(there) + np.mean(back)) / 2
            share = way * (length[i] + length[j]) / 2 / max(cap[i] + cap[j], 1e-300)
            if share < LARGEST_SHARE:
                found.append((float(share), i, j))
    return sorted(found)[:MOST_PAIRS]


def _cap_area(points: Floats) -> float:
    """Area of the cone over a closed line from its middle."""
    middle = points.mean(axis=0)
    crosses = np.cross(points - middle, np.roll(points, -1, axis=0) - middle)
    return float(np.linalg.norm(crosses, axis=1).sum() / 2)


def _bridge(vertices: Vertices, first: Ints, second: Ints) -> tuple[int, int, bool]:
    """Nearest vertices of two rims, and whether the rims run the same way, as a band between them must not."""
    distance, at = (np.asarray(found) for found in cKDTree(vertices[second]).query(vertices[first]))
    start = int(np.argmin(distance))
    ahead = np.roll(vertices[first], -1, axis=0) - np.roll(vertices[first], 1, axis=0)
    beside = np.roll(vertices[second], -1, axis=0) - np.roll(vertices[second], 1, axis=0)
    alike = float(np.einsum("ij,ij->", ahead, beside[at])) > 0.0
    return int(first[start]), int(second[at[start]]), alike
