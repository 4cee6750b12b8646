"""Pieces that do not belong to the surface."""

from __future__ import annotations

import numpy as np

from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from subjects.damage.places import Floats, Generator
from subjects.generated.pieces import together
from subjects.generated.revolved import ball


def with_crumbs(mesh: Mesh, generator: Generator, count: int, size_mm: float, away_mm: float) -> Mesh:
    """Small closed balls at this distance above the surface; below it if negative."""
    chosen = generator.choice(np.unique(mesh.faces), count, replace=False)
    places = mesh.vertices[chosen] + away_mm * vertex_normals(mesh.vertices, mesh.faces)[chosen]
    crumbs = [_at(ball(size_mm, 1), place) for place in places]
    return together(mesh, *crumbs).rounded_to_float32()


def with_scraps(mesh: Mesh, generator: Generator, count: int, size_mm: float, away_mm: float) -> Mesh:
    """Open scraps of two faces above the surface, or below it."""
    chosen = generator.choice(np.unique(mesh.faces), count, replace=False)
    places = mesh.vertices[chosen] + away_mm * vertex_normals(mesh.vertices, mesh.faces)[chosen]
    square = size_mm * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.2], [0, 1, 0]])
    scraps = [_at(Mesh.of(square, [[0, 1, 2], [0, 2, 3]]), place) for place in places]
    return together(mesh, *scraps).rounded_to_float32()


def with_inner_sheet(mesh: Mesh, point: Floats, size_mm: float) -> Mesh:
    """An open sheet of many faces around a point."""
    sheet = ball(size_mm, 2)
    half = sheet.faces[(sheet.triangles().mean(axis=1)[:, 2] > 0.0)]
    return together(mesh, _at(Mesh.of(sheet.vertices, half), point)).rounded_to_float32()


def _at(mesh: Mesh, place: Floats) -> Mesh:
    return mesh.with_vertices(mesh.vertices + place)
