"""Which way faces look: all alike, or could they."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Edges
from core.geometry.components import label_connected

Ints = NDArray[np.int64]


def find_inconsistent_edges(edges: Edges) -> tuple[Ints, Ints]:
    """Edges whose two faces run along them in the same direction, so that one of the faces looks the wrong way.

    Returns edge (K,), faces (K, 2). Only edges with exactly two faces can be judged.
    """
    edge, faces, side = edges.two_faces()
    bad = edges.forward[faces[:, 0], side[:, 0]] == edges.forward[faces[:, 1], side[:, 1]]
    # a degenerate side has no direction
    bad &= edges.ends[edge, 0] != edges.ends[edge, 1]
    return edge[bad], faces[bad]


def find_faces_to_flip(edges: Edges) -> Ints | None:
    """The fewest faces whose flipping makes all neighbours agree, (K,) ascending; None for a one-sided surface.

    Source: connected components of the double cover (every face twice, once each way round).
    """
    edge, faces, side = edges.two_faces()
    same_way = edges.forward[faces[:, 0], side[:, 0]] == edges.forward[faces[:, 1], side[:, 1]]
    same_way &= edges.ends[edge, 0] != edges.ends[edge, 1]
    count = len(edges.of_face)
    first = np.concatenate((faces[:, 0], faces[:, 0] + count))
    second = np.concatenate((faces[:, 1] + np.where(same_way, count, 0), faces[:, 1] + np.where(same_way, 0, count)))
    sheets, sheet = label_connected(2 * count, first, second)
    front, back = sheet[:count], sheet[count:]
    if (front == back).any():
        return None
    # of the two sheets over a piece, keep the one with more faces the right way round; a tie goes to the first face
    votes = np.bincount(front, minlength=sheets)
    keeps = (votes[front] > votes[back]) | ((votes[front] == votes[back]) & (front < back))
    return np.flatnonzero(~keeps)
