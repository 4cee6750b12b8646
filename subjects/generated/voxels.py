"""Surfaces of labelled volumes: the staircases and the noise that segmentation leaves."""

from __future__ import annotations

from collections.abc import Callable

import igl
import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh

Floats = NDArray[np.float64]


def isosurface(value: Callable[[Floats], Floats], half_mm: float, voxel_mm: float) -> Mesh:
    """Marching cubes of a function of place over a cube of side 2 * half_mm; inside is where it is positive."""
    axis = np.arange(-half_mm, half_mm + voxel_mm / 2, voxel_mm)
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1)
    points = grid.transpose(2, 1, 0, 3).reshape(-1, 3)  # x runs fastest
    vertices, faces, _edges = igl.marching_cubes(-value(points), points, len(axis), len(axis), len(axis))
    volume = np.einsum("fi,fi->f", vertices[faces[:, 0]], np.cross(vertices[faces[:, 1]], vertices[faces[:, 2]])).sum()
    return Mesh.of(vertices, faces if volume > 0 else faces[:, ::-1]).rounded_to_float32()


def staircase_ball(radius_mm: float, voxel_mm: float) -> Mesh:
    """A ball of whole voxels: every voxel is in or out, so slopes become steps."""
    return isosurface(lambda p: (np.linalg.norm(p, axis=1) < radius_mm).astype(float) - 0.5, radius_mm + 3 * voxel_mm, voxel_mm)


def staircase_ellipsoid(a_mm: float, b_mm: float, c_mm: float, voxel_mm: float) -> Mesh:
    """An egg of whole voxels, tilted against the grid."""
    tilt = np.array([[0.8, -0.6, 0.0], [0.48, 0.64, -0.6], [0.36, 0.48, 0.8]])

    def inside(p: Floats) -> Floats:
        filled: Floats = (np.linalg.norm(p @ tilt.T / (a_mm, b_mm, c_mm), axis=1) < 1.0).astype(float) - 0.5
        return filled

    return isosurface(inside, max(a_mm, b_mm, c_mm) + 3 * voxel_mm, voxel_mm)


def gyroid_ball(radius_mm: float, period_mm: float, voxel_mm: float) -> Mesh:
    """A sponge: a gyroid lattice cut to a ball; high genus, walls and pores of like width."""

    def value(p: Floats) -> Floats:
        x, y, z = (2 * np.pi / period_mm * p).T
        lattice = np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x)
        wall: Floats = np.minimum(0.6 - np.abs(lattice), (radius_mm - np.linalg.norm(p, axis=1)) / period_mm)
        return wall

    return isosurface(value, radius_mm + 3 * voxel_mm, voxel_mm)


def blobs(count: int, size_mm: float, voxel_mm: float, seed: int = 0) -> Mesh:
    """Merged droplets: smooth, with necks."""
    generator = np.random.default_rng(seed)
    centres = generator.uniform(-0.5, 0.5, (count, 3)) * size_mm
    radii = generator.uniform(0.25, 0.4, count) * size_mm

    def value(p: Floats) -> Floats:
        density = np.zeros(len(p))
        for centre, radius in zip(centres, radii, strict=True):
            density += np.exp(-((np.linalg.norm(p - centre, axis=1) / radius) ** 2))
        return density - 0.5

    return isosurface(value, 1.2 * size_mm, voxel_mm)
