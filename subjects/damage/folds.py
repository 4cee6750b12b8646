"""Surfaces that run through themselves."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from subjects.damage.places import Generator, near, nearest_vertex, rings_around, some_vertices, usual_edge

Floats = NDArray[np.float64]


def offset_naively(mesh: Mesh, point: Floats, radius_mm: float, depth_mm: float) -> Mesh:
    """Moved inwards along the normals by the depth, fading to nothing at the radius: thin and hollow parts fold."""
    inside = near(mesh, point, radius_mm)
    away = np.linalg.norm(mesh.vertices - mesh.vertices[nearest_vertex(mesh, point)], axis=1) / radius_mm
    share = np.where(inside, np.clip(2 * (1 - away), 0.0, 1.0), 0.0)
    moved = mesh.vertices - depth_mm * share[:, None] * vertex_normals(mesh.vertices, mesh.faces)
    return mesh.with_vertices(moved).rounded_to_float32()


def folded(mesh: Mesh, generator: Generator, count: int) -> Mesh:
    """Vertices moved along the surface, past their neighbours and beyond."""
    vertices = mesh.vertices.copy()
    for vertex in some_vertices(mesh, generator, count, 3):
        ring = np.flatnonzero(rings_around(mesh, [int(vertex)], 2) & ~rings_around(mesh, [int(vertex)], 1))
        vertices[vertex] += 1.1 * (mesh.vertices[generator.choice(ring)] - vertices[vertex])
    return mesh.with_vertices(vertices).rounded_to_float32()


def crumpled(mesh: Mesh, point: Floats, radius_mm: float, generator: Generator) -> Mesh:
    """Noise as wide as edges are long, around a place."""
    inside = near(mesh, point, radius_mm)
    edge_mm = usual_edge(Mesh.of(mesh.vertices, mesh.faces[inside[mesh.faces].any(axis=1)]))
    moved = mesh.vertices + inside[:, None] * generator.normal(scale=0.6 * edge_mm, size=mesh.vertices.shape)
    return mesh.with_vertices(moved).rounded_to_float32()


def pierced(mesh: Mesh, point: Floats, depth_mm: float) -> Mesh:
    """One vertex pulled inwards so far that it leaves the body on the other side."""
    vertex = nearest_vertex(mesh, point)
    vertices = mesh.vertices.copy()
    vertices[vertex] -= depth_mm * vertex_normals(mesh.vertices, mesh.faces)[vertex]
    return mesh.with_vertices(vertices).rounded_to_float32()
