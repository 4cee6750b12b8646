"""Borders: sides of faces that no other face shares, and the loops they form."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Edges, edges
from core.geometry.components import label_connected
from core.mesh import Faces

Ints = NDArray[np.int64]


def border_sides(found: Edges) -> tuple[Ints, Ints]:
    """Faces and sides (K,) at edges with a single face, by face."""
    face, side = np.nonzero(found.face_count[found.of_face] == 1)
    return face, side


def fans(found: Edges) -> Ints:
    """Number of the fan at each corner, (F, 3): corners of one vertex between which one can walk over edges with two faces."""
    _edge, face, side = found.two_faces()
    first, second = (3 * face + side).T
    next_first, next_second = (3 * face + (side + 1) % 3).T
    same_way = found.forward[face[:, 0], side[:, 0]] == found.forward[face[:, 1], side[:, 1]]
    _count, fan = label_connected(
        found.of_face.size,
        np.concatenate((first, next_first)),
        np.concatenate((np.where(same_way, second, next_second), np.where(same_way, next_second, second))),
    )
    return fan.reshape(-1, 3)


def find_loops(faces: Faces) -> list[Ints]:
    """Rims of holes: closed lines of vertices, each in the direction in which patches run, against the sides of the faces.

    Needs edges with at most two faces and consistent orientation. A line that comes back to a vertex is cut there, so no
    loop has a vertex twice: holes that meet in a vertex are told apart. Ordered by their first side.
    """
    found = edges(faces)
    face, side = border_sides(found)
    if len(face) == 0:
        return []
    fan = fans(found)
    leaves = np.full(int(fan.max()) + 1, -1, dtype=np.int64)
    leaves[fan[face, side]] = np.arange(len(face))
    following = leaves[fan[face, (side + 1) % 3]].tolist()
    tails = faces[face, side].tolist()
    seen = [False] * len(face)
    loops: list[Ints] = []
    for start in range(len(face)):
        line: list[int] = []
        place: dict[int, int] = {}
        at = start
        while not seen[at]:
            seen[at] = True
            vertex = tails[at]
            if vertex in place:
                begin = place[vertex]
                loops.append(np.array(line[begin:][::-1], dtype=np.int64))
                for gone in line[begin:]:
                    del place[gone]
                del line[begin:]
            place[vertex] = len(line)
            line.append(vertex)
            at = following[at]
        if line:
            loops.append(np.array(line[::-1], dtype=np.int64))
    return loops
