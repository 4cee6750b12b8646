"""Few faces that make a surface one-sided: a strip that runs through it the wrong way round."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order

from core.geometry.adjacency import edges
from core.geometry.components import face_components
from core.healing.change import Change, Staged
from core.mesh import Faces, Vertices

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]

LARGEST_SHARE = 0.02  # of the faces of a piece: a surface that has to lose more is one-sided by nature
FEWEST = 8  # faces that may go from a small piece, if they are no more than a tenth of it


def cut_twists(vertices: Vertices, faces: Faces) -> Staged:
    """Take out the faces where walks over the surface, from one face outwards, meet and disagree about the side.

    The walks are breadth first, so they part and meet near the twist. Nothing is taken if that would be many faces.
    """
    found = edges(faces)
    _edge, pair, side = found.two_faces()
    same_way = found.forward[pair[:, 0], side[:, 0]] == found.forward[pair[:, 1], side[:, 1]]
    _count, piece = face_components(found)
    turned = _walk(len(faces), pair, same_way, np.unique(piece, return_index=True)[1])
    disagree = (turned[pair[:, 0]] != turned[pair[:, 1]]) != same_way
    gone = np.zeros(len(faces), dtype=np.bool_)
    gone[pair[disagree]] = True
    losses, sizes = np.bincount(piece[gone], minlength=piece.max() + 1), np.bincount(piece)
    if not gone.any() or (losses > np.maximum(LARGEST_SHARE * sizes, np.minimum(FEWEST, sizes / 10))).any():
        return vertices, faces, []
    triangles = vertices[faces[gone]]
    message = f"{int(gone.sum())} faces that made the surface one-sided were taken out"
    points = triangles.mean(axis=1)
    return vertices, faces[~gone], [Change("twists", message, points, np.zeros(len(points)), taken=triangles)]


def _walk(count: int, pair: Ints, same_way: Flags, starts: Ints) -> Flags:
    """Which faces have to be turned over to agree with the face before them on the walk, (F,)."""
    rows, columns = pair.T
    graph = coo_array((np.ones(len(pair), dtype=np.int8), (rows, columns)), shape=(count, count)).tocsr()
    flips = {(int(a), int(b)): bool(turn) for (a, b), turn in zip(pair, same_way, strict=True)}
    turned = np.zeros(count, dtype=np.bool_)
    for start in starts.tolist():
        order, before = breadth_first_order(graph, start, directed=False)
        for face in order[1:].tolist():
            last = int(before[face])
            turned[face] = turned[last] != flips[min(face, last), max(face, last)]
    return turned
