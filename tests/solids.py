"""Small meshes whose every number can be counted by hand, in mm; outward faces unless the name says otherwise."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from core.mesh import Mesh


def tetrahedron(size: float = 1.0, at: ArrayLike = (0.0, 0.0, 0.0)) -> Mesh:
    """Corner of a cube: edges `size` along the axes from `at`; volume size³ / 6."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * size + np.asarray(at, dtype=float)
    return Mesh.of(vertices, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


def cube(size: float = 1.0, at: ArrayLike = (0.0, 0.0, 0.0)) -> Mesh:
    """Axis-aligned, from `at` to `at` + size; 8 vertices, 12 faces."""
    vertices = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * size + np.asarray(at, dtype=float)
    squares = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return Mesh.of(vertices, [face for a, b, c, d in squares for face in ((a, b, c), (a, c, d))])


def octahedron(radius: float = 1.0) -> Mesh:
    """Around the origin; 6 vertices, 8 faces, volume 4/3 radius³."""
    vertices = np.vstack((np.eye(3), -np.eye(3))) * radius
    faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    return Mesh.of(vertices, faces)


def sphere(radius: float = 1.0, subdivisions: int = 2, at: ArrayLike = (0.0, 0.0, 0.0)) -> Mesh:
    """Octahedron subdivided onto a sphere: 8 · 4^subdivisions faces."""
    base = octahedron()
    vertices, faces = base.vertices, base.faces
    for _ in range(subdivisions):
        sides = np.sort(np.vstack((faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]])), axis=1)
        ends, of_side = np.unique(sides, axis=0, return_inverse=True)
        ab, bc, ca = of_side.reshape(3, -1) + len(vertices)
        a, b, c = faces.T
        vertices = np.vstack((vertices, vertices[ends].mean(axis=1)))
        faces = np.vstack([np.column_stack(three) for three in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    vertices = vertices / np.linalg.norm(vertices, axis=1)[:, None]
    return Mesh.of(vertices * radius + np.asarray(at, dtype=float), faces)


def torus(big: float = 3.0, small: float = 1.0, around: int = 12, across: int = 8) -> Mesh:
    """Genus 1; around · across vertices, twice as many faces."""
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(across) * 2 * np.pi / across, indexing="ij")
    ring = big + small * np.cos(v)
    vertices = np.stack((ring * np.cos(u), ring * np.sin(u), small * np.sin(v)), axis=-1).reshape(-1, 3)
    faces = []
    for i in range(around):
        for j in range(across):
            a, b = i * across + j, (i + 1) % around * across + j
            c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
            faces += [(a, b, c), (a, c, d)]
    return Mesh.of(vertices, faces)


def moebius_strip(segments: int = 8) -> Mesh:
    """One-sided band: 2 · segments faces, one boundary of 2 · segments edges."""
    angle = np.arange(segments) * 2 * np.pi / segments
    vertices = []
    for a in angle:
        out = np.array([np.cos(a), np.sin(a), 0.0])
        across = np.cos(a / 2) * out + np.sin(a / 2) * np.array([0.0, 0.0, 1.0])
        vertices += [3 * out - across, 3 * out + across]
    faces = []
    for i in range(segments):
        a, b = 2 * i, 2 * i + 1
        c, d = (2 * i + 2, 2 * i + 3) if i + 1 < segments else (1, 0)
        faces += [(a, c, b), (b, c, d)]
    return Mesh.of(vertices, faces)


def without_faces(mesh: Mesh, faces: ArrayLike) -> Mesh:
    """The mesh with some faces taken out; its vertices all stay."""
    return Mesh.of(mesh.vertices, np.delete(mesh.faces, faces, axis=0))


def with_faces(mesh: Mesh, faces: ArrayLike) -> Mesh:
    """The mesh with faces (K, 3) added behind its own."""
    return Mesh.of(mesh.vertices, np.vstack((mesh.faces, np.asarray(faces))))


def flipped(mesh: Mesh, faces: ArrayLike | None = None) -> Mesh:
    """The mesh with some faces, or all, turned round."""
    turned = mesh.faces.copy()
    chosen = slice(None) if faces is None else np.asarray(faces)
    turned[chosen] = turned[chosen][:, ::-1]
    return Mesh.of(mesh.vertices, turned)


def together(*meshes: Mesh) -> Mesh:
    """Several meshes as pieces of one."""
    offsets = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    return Mesh.of(
        np.vstack([mesh.vertices for mesh in meshes]),
        np.vstack([mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=False)]),
    )
