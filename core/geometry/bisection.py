"""Longest edges halved: finer faces on the same surface, without a hanging vertex and without needles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Edges, edges
from core.mesh import Faces, Vertices

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]


def longest_edges(vertices: Vertices, faces: Faces) -> Floats:
    """Length of the longest edge of every face, (F,) mm."""
    corners = vertices[faces]
    length: Floats = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    return length


def halve_longest_edges(vertices: Vertices, faces: Faces, wanted: Flags) -> tuple[Vertices, Faces]:
    """Put a vertex on the longest edge of every wanted face (F,), and on those of neighbours that this asks for.

    Needs:    closed manifold.
    Promises: vertices keep place and number, new ones follow, on the middles of edges as float32 holds them; faces that are
              not split keep their corners. However often it is repeated, angles stay above half of the smallest there was.
    Source:   Rivara 1984, doi:10.1002/nme.1620200412 (bisection of longest edges, conforming)."""
    found = edges(faces)
    length = np.linalg.norm(vertices[found.ends[:, 0]] - vertices[found.ends[:, 1]], axis=1)
    longest = found.of_face[np.arange(len(faces)), length[found.of_face].argmax(axis=1)]
    return _split(vertices, faces, found, _close(found, longest, wanted), longest)


def _close(found: Edges, longest: Ints, wanted: Flags) -> Flags:
    """Edges to halve, (E,): with any edge of a face its longest one, so that no angle is halved twice."""
    marked = np.zeros(len(found.ends), dtype=bool)
    marked[longest[wanted]] = True
    while True:
        pulled = longest[marked[found.of_face].any(axis=1)]
        if marked[pulled].all():
            return marked
        marked[pulled] = True


def _split(vertices: Vertices, faces: Faces, found: Edges, marked: Flags, longest: Ints) -> tuple[Vertices, Faces]:
    """Put a vertex on every marked edge; each face with some is cut first at its longest edge, then at the others."""
    middle = np.full(len(marked), -1, dtype=np.int64)
    middle[marked] = len(vertices) + np.arange(int(marked.sum()))
    halves = vertices[found.ends[marked]].mean(axis=1).astype(np.float32).astype(np.float64)
    rows = np.flatnonzero(marked[found.of_face].any(axis=1))
    turn = (found.of_face[rows] == longest[rows, None]).argmax(axis=1)
    order = (turn[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(faces[rows].astype(np.int64), order, axis=1).T
    at_ab, at_bc, at_ca = middle[np.take_along_axis(found.of_face[rows], order, axis=1)].T
    parts = [np.delete(faces, rows, axis=0)]
    for start, end, cut in ((b, c, at_bc), (c, a, at_ca)):
        # the half of the face at the side start-end is (m, start, end), cut once more if that side has a vertex
        whole, halved = cut < 0, cut >= 0
        parts.append(np.column_stack((at_ab, start, end))[whole])
        parts.append(np.column_stack((at_ab, start, cut))[halved])
        parts.append(np.column_stack((at_ab, cut, end))[halved])
    return np.concatenate((vertices, halves)), np.concatenate(parts).astype(np.int32)
