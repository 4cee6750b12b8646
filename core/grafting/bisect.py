"""Finer faces along a wall, on the same surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.errors import LimitError
from core.geometry.bisection import halve_longest_edges, longest_edges
from core.grafting.wall import Box, wall_distance
from core.mesh import Mesh

ROUNDS = 40  # each halves edges: a metre would become a nanometre
MOST_NEW_FACES = 500_000


def bisect_at_wall(mesh: Mesh, boxes: Sequence[Box], *, margin_mm: float, edge_mm: float) -> Mesh:
    """Halve the longest edges of faces near the walls until they are no longer than `edge_mm`.

    Needs:    a closed manifold mesh.
    Promises: those of `halve_longest_edges`.
    Raises:   LimitError `graft.seam_too_fine`."""
    vertices, faces = mesh.vertices, mesh.faces
    most = len(faces) + MOST_NEW_FACES
    for _ in range(ROUNDS):
        length = longest_edges(vertices, faces)
        near = np.abs(wall_distance(vertices[faces].mean(axis=1), boxes)) <= margin_mm + length
        wanted = near & (length > edge_mm)
        if not wanted.any():
            break
        finer = halve_longest_edges(vertices, faces, wanted)
        if len(finer[1]) > most:
            raise LimitError(
                "graft.seam_too_fine",
                f"edges of {edge_mm:g} mm along the walls would take more than {MOST_NEW_FACES} faces; use a wider seam",
                edge_mm=edge_mm,
                limit=MOST_NEW_FACES,
            )
        vertices, faces = finer
    return mesh if len(faces) == len(mesh.faces) else Mesh.of(vertices, faces)
