"""Round surfaces: spheres, tori, links, screws, and whatever a radius over the sphere describes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import trimesh
from numpy.typing import NDArray

from core.mesh import Mesh

Floats = NDArray[np.float64]


def ball(radius_mm: float, subdivisions: int) -> Mesh:
    """20 * 4^subdivisions faces."""
    made = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius_mm)
    return Mesh.of(made.vertices, made.faces).rounded_to_float32()


def star_shape(radius_mm: Callable[[Floats], Floats], subdivisions: int) -> Mesh:
    """A ball whose radius depends on the direction: takes unit vectors (N, 3), gives (N,) mm."""
    made = trimesh.creation.icosphere(subdivisions=subdivisions)
    directions = np.asarray(made.vertices)
    return Mesh.of(directions * radius_mm(directions)[:, None], made.faces).rounded_to_float32()


def bumpy(radius_mm: float, height_mm: float, waves: int, subdivisions: int) -> Mesh:
    """Hills and valleys all over, like a golf ball or a cauliflower."""

    def radius(u: Floats) -> Floats:
        product: Floats = radius_mm + height_mm * np.sin(waves * u[:, 0]) * np.sin(waves * u[:, 1]) * np.sin(waves * u[:, 2] + 1)
        return product

    return star_shape(radius, subdivisions)


def spiked(radius_mm: float, spikes: int, height_mm: float, width: float, subdivisions: int, seed: int = 0) -> Mesh:
    """A ball with thin spikes in directions drawn at random; width: of a spike in radians."""
    tips = np.random.default_rng(seed).normal(size=(spikes, 3))
    tips /= np.linalg.norm(tips, axis=1)[:, None]

    def radius(u: Floats) -> Floats:
        angle = np.arccos(np.clip(u @ tips.T, -1.0, 1.0))
        tall: Floats = radius_mm + height_mm * np.exp(-((angle / width) ** 2)).max(axis=1)
        return tall

    return star_shape(radius, subdivisions)


def torus(major_mm: float, minor_mm: float, around: int = 96, across: int = 32) -> Mesh:
    """Genus 1."""
    made = trimesh.creation.torus(major_mm, minor_mm, major_sections=around, minor_sections=across)
    return Mesh.of(made.vertices, made.faces).rounded_to_float32()


def tube(path: Floats, radius_mm: Floats, across: int) -> Mesh:
    """A round tube along a closed path (N, 3) mm; radius (N,). Frames are carried along by projection."""
    ahead = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1)[:, None]
    side = np.empty_like(path)
    side[0] = np.cross(ahead[0], np.eye(3)[np.argmin(np.abs(ahead[0]))])
    for i in range(1, len(path)):
        side[i] = side[i - 1] - (side[i - 1] @ ahead[i]) * ahead[i]
        side[i] /= np.linalg.norm(side[i])
    side[0] /= np.linalg.norm(side[0])
    up = np.cross(ahead, side)
    # the frame comes back turned by some angle: undo it evenly along the way
    slip = np.arctan2(side[-1] @ up[0], side[-1] @ side[0])
    turn = 2 * np.pi * np.arange(across) / across
    angle = turn[None, :] - slip * np.linspace(0, 1, len(path), endpoint=False)[:, None]
    ring = np.cos(angle)[..., None] * side[:, None] + np.sin(angle)[..., None] * up[:, None]
    vertices = (path[:, None] + radius_mm[:, None, None] * ring).reshape(-1, 3)
    at, turn_at = np.meshgrid(np.arange(len(path)), np.arange(across), indexing="ij")
    next_at, next_turn = (at + 1) % len(path) * across, (turn_at + 1) % across
    a, b, c, d = at * across + turn_at, next_at + turn_at, next_at + next_turn, at * across + next_turn
    faces = np.concatenate([np.stack(corners, axis=-1).reshape(-1, 3) for corners in ((a, b, c), (a, c, d))])
    volume = np.einsum("fi,fi->f", vertices[faces[:, 0]], np.cross(vertices[faces[:, 1]], vertices[faces[:, 2]])).sum()
    return Mesh.of(vertices, faces if volume > 0 else faces[:, ::-1]).rounded_to_float32()


def knot(size_mm: float, radius_mm: float, along: int, across: int) -> Mesh:
    """A trefoil."""
    t = 2 * np.pi * np.arange(along) / along
    path = np.column_stack((np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t), -np.sin(3 * t))) * size_mm
    return tube(path, np.full(along, radius_mm), across)


def pinched_ring(major_mm: float, thick_mm: float, thin_mm: float) -> Mesh:
    """A ring whose tube goes from thick to thin and back four times."""
    t = 2 * np.pi * np.arange(240) / 240
    path = np.column_stack((major_mm * np.cos(t), major_mm * np.sin(t), np.zeros_like(t)))
    return tube(path, thin_mm + (thick_mm - thin_mm) * (0.5 + 0.5 * np.cos(4 * t)), 32)
