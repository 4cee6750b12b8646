"""Intersecting faces that belong together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import edges
from core.geometry.components import label_connected
from core.mesh import Faces

Flags = NDArray[np.bool_]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False, slots=True)
class Cluster:
    """faces: (K,) that intersect others here, ascending. patches: parts of the surface they lie on, two or more rings apart."""

    faces: Ints
    patches: int


def find_clusters(faces: Faces, vertex_count: int, pairs: Ints) -> list[Cluster]:
    """Group the faces of intersecting pairs (K, 2): those that intersect and those with a ring of faces in common."""
    bad = np.unique(pairs)
    if len(bad) == 0:
        return []
    reached = np.zeros(vertex_count, dtype=np.bool_)
    reached[faces[bad]] = True
    ends = edges(faces[reached[faces].any(axis=1)]).ends
    tips = faces[pairs][:, :, 0].astype(np.int64)
    _, patch = label_connected(vertex_count, *ends.T)
    _, cluster = label_connected(vertex_count, np.concatenate((ends[:, 0], tips[:, 0])), np.concatenate((ends[:, 1], tips[:, 1])))
    of_face, patch_of_face = cluster[faces[bad, 0]], patch[faces[bad, 0]]
    return [
        Cluster(bad[of_face == label], len(np.unique(patch_of_face[of_face == label])))
        for label in dict.fromkeys(of_face.tolist())
    ]
