"""Faces that should not be there or look the wrong way."""

from __future__ import annotations

import numpy as np

from core.mesh import Mesh
from subjects.damage.places import Generator, near, some_faces


def doubled(mesh: Mesh, generator: Generator, count: int, turned: bool = False) -> Mesh:
    """Some faces a second time, on request looking the other way."""
    again = mesh.faces[some_faces(mesh, generator, count)]
    return Mesh.of(mesh.vertices, np.concatenate((mesh.faces, again[:, ::-1] if turned else np.roll(again, 1, axis=1))))


def repeating_corners(mesh: Mesh, generator: Generator, count: int) -> Mesh:
    """Additional faces that name a corner twice."""
    lines = mesh.faces[some_faces(mesh, generator, count)][:, [0, 1, 1]]
    return Mesh.of(mesh.vertices, np.concatenate((mesh.faces, lines)))


def capped(mesh: Mesh, generator: Generator, count: int, height_mm: float = 0.0) -> Mesh:
    """Faces split in two at the middle of a side, and the gap to the neighbour closed by a face as flat as float32 allows.

    height_mm: how far the middle is shifted into the face.
    """
    chosen = some_faces(mesh, generator, count)
    a, b, c = mesh.faces[chosen].T
    corner = [mesh.vertices[vertices] for vertices in (a, b, c)]
    middle = (corner[0] + corner[1]) / 2
    inwards = corner[2] - middle
    middle = middle + height_mm * inwards / np.linalg.norm(inwards, axis=1)[:, None]
    m = len(mesh.vertices) + np.arange(len(chosen))
    parts = [np.column_stack(corners) for corners in ((a, m, c), (m, b, c), (a, b, m))]
    faces = np.concatenate((np.delete(mesh.faces, chosen, axis=0), *parts))
    return Mesh.of(np.concatenate((mesh.vertices, middle.astype(np.float32))), faces)


def needled(mesh: Mesh, generator: Generator, count: int, width_mm: float) -> Mesh:
    """Corners of faces doubled at this distance, which leaves two needles each, as careless booleans do."""
    vertices, faces = mesh.vertices.copy(), mesh.faces.astype(np.int64)
    for face in some_faces(mesh, generator, count):
        a, b, _c = faces[face]
        at_edge = np.flatnonzero((faces == a).any(axis=1) & (faces == b).any(axis=1))
        towards = vertices[b] - vertices[a]
        place = (vertices[a] + width_mm * towards / np.linalg.norm(towards)).astype(np.float32)
        new = len(vertices)
        vertices = np.concatenate((vertices, place[None]))
        near_a, near_b = faces[at_edge].copy(), faces[at_edge].copy()
        near_a[near_a == b] = new
        near_b[near_b == a] = new
        faces = np.concatenate((np.delete(faces, at_edge, axis=0), near_a, near_b))
    return Mesh.of(vertices, faces)


def flipped(mesh: Mesh, generator: Generator, share: float) -> Mesh:
    """A share of the faces, drawn at random, turned round."""
    faces = mesh.faces.copy()
    turned = generator.random(len(faces)) < share
    faces[turned] = faces[turned][:, ::-1]
    return Mesh.of(mesh.vertices, faces)


def flipped_patch(mesh: Mesh, generator: Generator, radius_mm: float) -> Mesh:
    """All faces around a place turned round."""
    faces = mesh.faces.copy()
    inside = near(mesh, mesh.vertices[generator.choice(mesh.faces.ravel())], radius_mm)[faces].any(axis=1)
    faces[inside] = faces[inside][:, ::-1]
    return Mesh.of(mesh.vertices, faces)
