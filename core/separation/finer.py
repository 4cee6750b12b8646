"""Finer faces where tissues stay too close: a face much larger than a tissue is thick cannot bend around its neighbour."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from core.geometry.bisection import halve_longest_edges, longest_edges
from core.geometry.exact_intersection import find_intersecting_faces
from core.mesh import Mesh
from core.separation.opening import Closeness
from core.separation.tissue import Tissue

Flags = NDArray[np.bool_]

SHORTEST_GAPS = 4.0  # no edge shorter than this many gaps is halved: there the faces are not what stands in the way
RINGS = 2  # of neighbours that are halved with a face, so that what must bend has room to
HALVINGS = 2  # of longest edges in one refinement: that halves all edges of a face
MOST_NEW_FACES = 50_000  # in one tissue


def refine_stuck(
    tissues: Mapping[str, Tissue], left: Sequence[Closeness], gap_mm: float, came: Mapping[str, int]
) -> dict[str, Mesh]:
    """Movable tissues with finer faces where they stay too close to others, as they came else; empty if nothing can be halved.

    left: pairs not apart. came: faces each tissue had at first.
    Promises: the same surfaces but for rounding to float32, free of self-intersection (exact)."""
    finer = {}
    for name, tissue in tissues.items():
        stuck = _stuck_faces(name, tissue, left)
        if not tissue.movable or not stuck.any():
            continue
        made = _halved(tissue.original, stuck, gap_mm)
        if made is None or len(made.faces) > came[name] + MOST_NEW_FACES:
            continue
        if len(find_intersecting_faces(made.vertices, made.faces)) == 0:
            finer[name] = made
    return finer


def _stuck_faces(name: str, tissue: Tissue, left: Sequence[Closeness]) -> Flags:
    faces = tissue.original.faces
    stuck = np.zeros(len(faces), dtype=np.bool_)
    for closeness in left:
        for owner, contacts, wrong in zip((closeness.a, closeness.b), closeness.contacts, closeness.wrong, strict=True):
            if owner == name:
                stuck[contacts.faces] = True
                stuck[np.isin(faces, wrong).any(axis=1)] = True
    return stuck


def _halved(mesh: Mesh, stuck: Flags, gap_mm: float) -> Mesh | None:
    """None if all edges there are short already."""
    for _ in range(RINGS):
        touched = np.zeros(len(mesh.vertices), dtype=np.bool_)
        touched[mesh.faces[stuck]] = True
        stuck = np.asarray(touched[mesh.faces].any(axis=1))
    near = np.unique(mesh.faces[stuck])
    vertices, faces = mesh.vertices, mesh.faces
    for _ in range(HALVINGS):
        inside = np.zeros(len(vertices), dtype=np.bool_)
        inside[near] = True
        inside[len(mesh.vertices) :] = True
        wanted = inside[faces].all(axis=1) & (longest_edges(vertices, faces) > SHORTEST_GAPS * gap_mm)
        if not wanted.any():
            break
        vertices, faces = halve_longest_edges(vertices, faces, wanted)
    return Mesh.of(vertices, faces) if len(faces) > len(mesh.faces) else None
