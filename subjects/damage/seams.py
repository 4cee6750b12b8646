"""Surfaces that fall apart: each face alone, patches side by side, cracks, vertices on one side of an edge only."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from subjects.damage.places import Generator, some_faces


def soup(mesh: Mesh) -> Mesh:
    """Every face with corners of its own, as STL has it."""
    return Mesh.of(mesh.triangles().reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))


def parted(mesh: Mesh, generator: Generator, patches: int, width_mm: float = 0.0) -> Mesh:
    """Patches around places drawn at random, each with a rim of its own; the rims are this far apart, give or take."""
    centres = mesh.vertices[generator.choice(np.unique(mesh.faces), patches, replace=False)]
    middles = mesh.triangles().mean(axis=1)
    patch = np.linalg.norm(middles[:, None] - centres[None], axis=2).argmin(axis=1)
    keys, corner = np.unique(mesh.faces + len(mesh.vertices) * patch[:, None], return_inverse=True)
    _patch, vertex = np.divmod(keys, len(mesh.vertices))
    faces = corner.reshape(-1, 3)
    vertices = mesh.vertices[vertex]
    at_rim = np.bincount(vertex, minlength=len(mesh.vertices))[vertex] > 1
    if width_mm > 0.0:
        vertices = vertices + (at_rim * generator.uniform(0.3, 1.0, len(keys)))[:, None] * width_mm / 2 * _inwards(
            vertices, faces
        )
    return Mesh.of(vertices, faces).rounded_to_float32()


def _inwards(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Unit vectors from each vertex to the middle of its faces, (V, 3)."""
    middles = vertices[faces].mean(axis=1)
    total = np.column_stack([np.bincount(faces.ravel(), np.repeat(middles[:, i], 3), len(vertices)) for i in range(3)])
    inwards = total / np.bincount(faces.ravel(), minlength=len(vertices))[:, None] - vertices
    unit: NDArray[np.float64] = inwards / np.maximum(np.linalg.norm(inwards, axis=1), 1e-12)[:, None]
    return unit


def with_t_junctions(mesh: Mesh, generator: Generator, count: int, parts: int = 2) -> Mesh:
    """Sides of faces cut into some parts, by vertices that the neighbours across them know nothing of."""
    vertices, faces = [mesh.vertices], [mesh.faces]
    chosen = some_faces(mesh, generator, count)
    first = len(mesh.vertices)
    for face in chosen:
        a, b, c = mesh.faces[face]
        shares = np.arange(1, parts)[:, None] / parts
        vertices.append((mesh.vertices[a] * (1 - shares) + mesh.vertices[b] * shares).astype(np.float32))
        chain = [a, *range(first, first + parts - 1), b]
        first += parts - 1
        faces.append(np.array([[start, end, c] for start, end in pairwise(chain)], dtype=np.int32))
    faces[0] = np.delete(mesh.faces, chosen, axis=0)
    return Mesh.of(np.concatenate(vertices), np.concatenate(faces))
