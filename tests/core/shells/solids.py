"""Closed surfaces whose inner offsets are known in closed form."""

from __future__ import annotations

import numpy as np
import trimesh

from core.mesh import Mesh


def as_mesh(solid: trimesh.Trimesh) -> Mesh:
    """With float32 coordinates, like every skin the process works on."""
    return Mesh.of(solid.vertices, solid.faces).rounded_to_float32()


def sphere(radius_mm: float = 20.0, subdivisions: int = 4) -> Mesh:
    """Inner offset d: a sphere of radius r - d."""
    return as_mesh(trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius_mm))


def torus(major_mm: float = 30.0, minor_mm: float = 8.0) -> Mesh:
    """Inner offset d: the torus with minor radius r - d."""
    return as_mesh(trimesh.creation.torus(major_mm, minor_mm, major_sections=128, minor_sections=48))


def capsule(radius_mm: float = 10.0, height_mm: float = 40.0) -> Mesh:
    """Inner offset d: a capsule with radius r - d and the same axis."""
    return as_mesh(trimesh.creation.capsule(height=height_mm, radius=radius_mm, count=[48, 48]))


def cube(side_mm: float = 60.0, cuts: int = 0) -> Mesh:
    """Inner offset d: a cube of side a - 2d."""
    solid = trimesh.creation.box((side_mm, side_mm, side_mm))
    for _ in range(cuts):
        solid = solid.subdivide()
    return as_mesh(solid)


def plate(side_mm: float = 40.0, thickness_mm: float = 2.0) -> Mesh:
    """Thinner than a body layer: its reach is half the thickness, but for the rim."""
    solid = trimesh.creation.box((side_mm, side_mm, thickness_mm))
    for _ in range(4):
        solid = solid.subdivide()
    return as_mesh(solid)


def cone(half_angle_deg: float, sides: int, height_mm: float = 30.0) -> Mesh:
    """A regular cone, apex at the origin pointing up, every side face at the same angle to the axis."""
    radius = height_mm * np.tan(np.radians(half_angle_deg))
    turn = 2 * np.pi * np.arange(sides) / sides
    rim = np.column_stack((radius * np.cos(turn), radius * np.sin(turn), np.full(sides, -height_mm)))
    vertices = np.vstack(([[0.0, 0.0, 0.0]], rim, [[0.0, 0.0, -height_mm]]))
    nxt = (np.arange(sides) + 1) % sides
    ring = np.arange(sides)
    flank = np.column_stack((np.zeros(sides, int), ring + 1, nxt + 1))
    base = np.column_stack((np.full(sides, sides + 1), nxt + 1, ring + 1))
    return Mesh.of(vertices, np.vstack((flank, base)))
