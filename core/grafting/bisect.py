"""Finer faces along a wall, on the same surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.errors import LimitError
from core.geometry.adjacency import Edges, edges
from core.grafting.wall import Box, wall_distance
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ROUNDS = 40  # each halves edges: a metre would become a nanometre
MOST_NEW_FACES = 500_000


def bisect_at_wall(mesh: Mesh, boxes: Sequence[Box], *, margin_mm: float, edge_mm: float) -> Mesh:
    """Halve the longest edges of faces near the walls until they are no longer than `edge_mm`.

    Needs:    a closed manifold mesh.
    Promises: vertices keep place and number, new ones follow, on the middles of edges as float32 holds them; faces that are
              not split keep their corners. Angles stay above half of the smallest there was.
    Raises:   LimitError `graft.seam_too_fine`.
    Source:   Rivara 1984, doi:10.1002/nme.1620200412 (bisection of longest edges, conforming)."""
    vertices, faces = mesh.vertices, mesh.faces.astype(np.int64)
    most = len(faces) + MOST_NEW_FACES
    for _ in range(ROUNDS):
        found = edges(faces.astype(np.int32))
        length = np.linalg.norm(vertices[found.ends[:, 0]] - vertices[found.ends[:, 1]], axis=1)
        longest = found.of_face[np.arange(len(faces)), length[found.of_face].argmax(axis=1)]
        centre = vertices[faces].mean(axis=1)
        near = np.abs(wall_distance(centre, boxes)) <= margin_mm + length[longest]
        wanted = near & (length[longest] > edge_mm)
        if not wanted.any():
            break
        marked = _close(found, longest, wanted)
        if len(faces) + 2 * int(marked.sum()) > most:
            raise LimitError(
                "graft.seam_too_fine",
                f"edges of {edge_mm:g} mm along the walls would take more than {MOST_NEW_FACES} faces; use a wider seam",
                edge_mm=edge_mm,
                limit=MOST_NEW_FACES,
            )
        vertices, faces = _split(vertices, faces, found, marked, longest)
    return mesh if len(faces) == len(mesh.faces) else Mesh.of(vertices, faces)


def _close(found: Edges, longest: Ints, wanted: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Edges to halve, (E,): with any edge of a face its longest one, so that no angle is halved twice."""
    marked = np.zeros(len(found.ends), dtype=bool)
    marked[longest[wanted]] = True
    while True:
        pulled = longest[marked[found.of_face].any(axis=1)]
        if marked[pulled].all():
            return marked
        marked[pulled] = True


def _split(vertices: Floats, faces: Ints, found: Edges, marked: NDArray[np.bool_], longest: Ints) -> tuple[Floats, Ints]:
    """Put a vertex on every marked edge; each face with some is cut first at its longest edge, then at the others."""
    middle = np.full(len(marked), -1, dtype=np.int64)
    middle[marked] = len(vertices) + np.arange(int(marked.sum()))
    halves = vertices[found.ends[marked]].mean(axis=1).astype(np.float32).astype(np.float64)
    rows = np.flatnonzero(marked[found.of_face].any(axis=1))
    turn = (found.of_face[rows] == longest[rows, None]).argmax(axis=1)
    order = (turn[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(faces[rows], order, axis=1).T
    at_ab, at_bc, at_ca = middle[np.take_along_axis(found.of_face[rows], order, axis=1)].T
    parts = [np.delete(faces, rows, axis=0)]
    for start, end, cut in ((b, c, at_bc), (c, a, at_ca)):
        # the half of the face at the side start-end is (m, start, end), cut once more if that side has a vertex
        whole, halved = cut < 0, cut >= 0
        parts.append(np.column_stack((at_ab, start, end))[whole])
        parts.append(np.column_stack((at_ab, start, cut))[halved])
        parts.append(np.column_stack((at_ab, cut, end))[halved])
    return np.concatenate((vertices, halves)), np.concatenate(parts)
