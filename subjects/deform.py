"""Other poses of any surface by smooth deformations of space; connectivity stays, self-intersection may come."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh

Floats = NDArray[np.float64]


def scaled(mesh: Mesh, x: float, y: float, z: float) -> Mesh:
    """Stretched along the axes."""
    return mesh.with_vertices(mesh.vertices * (x, y, z)).rounded_to_float32()


def twisted(mesh: Mesh, degrees_per_metre: float) -> Mesh:
    """Turned about the y axis, more with height."""
    middle = mesh.vertices.mean(axis=0)
    x, y, z = (mesh.vertices - middle).T
    angle = np.radians(degrees_per_metre) * y / 1000.0
    turned = np.column_stack((np.cos(angle) * x + np.sin(angle) * z, y, np.cos(angle) * z - np.sin(angle) * x))
    return mesh.with_vertices(turned + middle).rounded_to_float32()


def bent(mesh: Mesh, radius_mm: float) -> Mesh:
    """Its y axis, the height, laid along a circle of this radius in the plane of y and z."""
    middle = mesh.vertices.mean(axis=0)
    x, y, z = (mesh.vertices - middle).T
    angle = y / radius_mm
    arm = radius_mm - z
    laid = np.column_stack((x, arm * np.sin(angle), radius_mm - arm * np.cos(angle)))
    return mesh.with_vertices(laid + middle).rounded_to_float32()


def waved(mesh: Mesh, amplitude_mm: float, length_mm: float) -> Mesh:
    """Ripples along all axes, like breathing and squeezing at once."""
    turns = 2 * np.pi * np.roll(mesh.vertices, 1, axis=1) / length_mm
    return mesh.with_vertices(mesh.vertices + amplitude_mm * np.sin(turns)).rounded_to_float32()


def rough(mesh: Mesh, deviation_mm: float, seed: int = 0) -> Mesh:
    """Scanner noise: every vertex shifted at random, normally distributed."""
    noise = np.random.default_rng(seed).normal(scale=deviation_mm, size=mesh.vertices.shape)
    return mesh.with_vertices(mesh.vertices + noise).rounded_to_float32()
