"""Connected pieces of a mesh, and the fans of faces around its vertices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from core.geometry.adjacency import Edges

Ints = NDArray[np.int64]


def label_connected(count: int, first: NDArray[np.integer], second: NDArray[np.integer]) -> tuple[int, Ints]:
    """Connected components of `count` nodes under the links first (L,) - second (L,): (number, label (count,)).

    Labels run from 0 in the order of each component's lowest node.
    """
    links = coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(count, count))
    found, labels = connected_components(links, directed=False)
    return int(found), labels.astype(np.int64)


def _neighbouring_sides(edges: Edges) -> tuple[Ints, Ints]:
    """Sides (3 face + corner) that lie at one edge, as links: n sides give n-1 links."""
    at_edge = edges.of_face.ravel()
    order = np.argsort(at_edge, kind="stable")
    same = at_edge[order[1:]] == at_edge[order[:-1]]
    return order[:-1][same], order[1:][same]


def face_components(edges: Edges) -> tuple[int, Ints]:
    """Pieces whose faces hang together by edges: (number, label (F,)). Faces that share only a corner are apart."""
    first, second = _neighbouring_sides(edges)
    return label_connected(len(edges.of_face), first // 3, second // 3)


def find_split_vertices(faces: NDArray[np.integer], edges: Edges) -> Ints:
    """Vertices whose faces form more than one fan, such as the waist of a bow tie; (K,) ascending.

    Faces at a vertex belong to one fan if one can walk between them over edges that end there. An edge with three
    faces does not split its ends: it is a fault of its own.
    """
    first, second = _neighbouring_sides(edges)
    # each face has one corner at either end of the shared edge: side i runs from corner i to corner i+1
    next_first, next_second = (side - side % 3 + (side % 3 + 1) % 3 for side in (first, second))
    same_way = edges.forward.ravel()[first] == edges.forward.ravel()[second]
    count, fan = label_connected(
        faces.size,
        np.concatenate((first, next_first)),
        np.concatenate((np.where(same_way, second, next_second), np.where(same_way, next_second, second))),
    )
    vertex_of_fan = np.empty(count, dtype=np.int64)
    vertex_of_fan[fan] = faces.ravel()
    return np.flatnonzero(np.bincount(vertex_of_fan) > 1)
