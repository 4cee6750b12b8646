"""From face, edge and vertex numbers to places a viewer can fly to."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.geometry.components import label_connected
from core.mesh import Mesh
from core.schema.finding import MAX_PLACES, Place

Ints = NDArray[np.int64]
DECIMALS = 6  # of places in mm: a nanometre, and the same on every processor


def point_of(coordinates: Sequence[float] | NDArray[np.float64]) -> tuple[float, float, float]:
    """A point in mm as reports hold it."""
    x, y, z = (round(float(value), DECIMALS) for value in coordinates)
    return x, y, z


def face_places(name: str, mesh: Mesh, faces: Ints) -> tuple[Place, ...]:
    """One place per face, at its middle; the first faces (K,) are kept."""
    return tuple(
        Place(mesh=name, point_mm=point_of(mesh.vertices[mesh.faces[face]].mean(axis=0)), faces=(int(face),))
        for face in faces[:MAX_PLACES]
    )


def edge_places(name: str, mesh: Mesh, ends: Ints, faces: Sequence[Sequence[int]]) -> tuple[Place, ...]:
    """One place per edge, at its middle; ends (K, 2) vertices, faces: those at each edge."""
    return tuple(
        Place(
            mesh=name,
            point_mm=point_of(mesh.vertices[pair].mean(axis=0)),
            faces=tuple(int(face) for face in at_edge[:MAX_PLACES]),
            vertices=(int(pair[0]), int(pair[1])),
        )
        for pair, at_edge in zip(ends[:MAX_PLACES], faces, strict=False)
    )


def vertex_places(name: str, mesh: Mesh, vertices: Ints) -> tuple[Place, ...]:
    """One place per vertex; the first vertices (K,) are kept."""
    return tuple(
        Place(mesh=name, point_mm=point_of(mesh.vertices[vertex]), vertices=(int(vertex),)) for vertex in vertices[:MAX_PLACES]
    )


def cluster_pairs(faces: NDArray[np.integer], pairs: Ints) -> list[Ints]:
    """Group pairs of faces that lie together: linked by a pair or by a shared corner.

    faces: (F, 3). pairs: (K, 2). Returns the face numbers of each cluster, ascending; largest cluster first.
    """
    members, of_pair = np.unique(pairs, return_inverse=True)
    corners, of_corner = np.unique(faces[members], return_inverse=True)
    links = of_pair.reshape(-1, 2)
    count, label = label_connected(
        len(members) + len(corners),
        np.concatenate((links[:, 0], np.repeat(np.arange(len(members)), 3))),
        np.concatenate((links[:, 1], of_corner.ravel() + len(members))),
    )
    order = np.argsort(label[: len(members)], kind="stable")
    sizes = np.bincount(label[: len(members)], minlength=count)
    clusters = np.split(members[order], np.cumsum(sizes)[:-1])
    return sorted(clusters, key=lambda cluster: -len(cluster))


def cluster_place(name: str, mesh: Mesh, faces: Ints) -> Place:
    """One place for a cluster of faces (K,), at the middle of the one that lies most centrally."""
    middles = mesh.vertices[mesh.faces[faces]].mean(axis=1)
    central = np.argmin(np.linalg.norm(middles - middles.mean(axis=0), axis=1))
    return Place(mesh=name, point_mm=point_of(middles[central]), faces=tuple(int(face) for face in faces[:MAX_PLACES]))
