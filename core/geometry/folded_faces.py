"""Faces folded over flat onto a neighbour with which they share an edge, decided exactly."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from core.geometry.meeting_faces import do_meet
from core.geometry.surely_apart import surely_apart

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


def find_folded_pairs(corners: Floats, places: Ints, chosen: Ints) -> Ints:
    """Pairs (K, 2) of the chosen faces (N,), ascending, that share an edge and lie on each other.

    corners: (F, 3, 3) mm. places: (F, 3), `position_ids` of the corners. All faces at an edge are compared with each other.
    """
    pairs = _pairs_at_edges(places, chosen)
    unsure = pairs[_is_unsure(corners, places, pairs)]
    folded: Ints = unsure[do_meet(corners, places, unsure)]
    return folded


def _pairs_at_edges(places: Ints, chosen: Ints) -> Ints:
    """Pairs of the chosen faces, lower number first, that share two places."""
    ends = places[chosen][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    edge = ends.min(axis=1) * (int(places.max(initial=0)) + 1) + ends.max(axis=1)
    order = np.argsort(edge, kind="stable")
    edge, face = edge[order], np.repeat(chosen, 3)[order]
    pairs, step = [np.empty((0, 2), dtype=np.int64)], 1
    while True:
        together = edge[step:] == edge[:-step]
        if not together.any():
            return np.concatenate(pairs)
        pairs.append(np.column_stack((face[:-step][together], face[step:][together])))
        step += 1


@njit(cache=True, nogil=True)
def _is_unsure(corners: Floats, places: Ints, pairs: Ints) -> NDArray[np.bool_]:
    unsure = np.empty(len(pairs), np.bool_)
    for row in range(len(pairs)):
        unsure[row] = not surely_apart(corners, places, pairs[row, 0], pairs[row, 1])
    return unsure
