"""Solids as labels of voxels, with the surface they were cut from."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.label_volume import LabelVolume

Distances = NDArray[np.float64]


def places(shape: tuple[int, int, int], affine: ArrayLike) -> NDArray[np.float64]:
    """Centres of voxels, (*shape, 3) mm."""
    frame = np.asarray(affine, dtype=float)
    voxels = np.moveaxis(np.indices(shape), 0, -1).astype(float)
    centres: NDArray[np.float64] = voxels @ frame[:3, :3].T + frame[:3, 3]
    return centres


def affine_of(sides: ArrayLike, turn: ArrayLike | None = None, centre_voxel: ArrayLike = (0.0, 0.0, 0.0)) -> NDArray[np.float64]:
    """Voxels of some sides in mm, turned, with the origin at a voxel of fractional number."""
    frame = np.eye(4)
    frame[:3, :3] = (np.eye(3) if turn is None else np.asarray(turn)) @ np.diag(np.asarray(sides, dtype=float))
    frame[:3, 3] = -frame[:3, :3] @ np.asarray(centre_voxel, dtype=float)
    return frame


def oblique() -> NDArray[np.float64]:
    """A rotation about no axis of the grid."""
    x, y = np.radians(25.0), np.radians(-40.0)
    about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    about_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    turned: NDArray[np.float64] = about_x @ about_y
    return turned


def spheres(radii: tuple[float, ...], affine: NDArray[np.float64]) -> LabelVolume:
    """Around the origin: label 1 in the largest, 2 in the next, and so on."""
    sides = np.linalg.norm(affine[:3, :3], axis=0)
    centre = -np.linalg.solve(affine[:3, :3], affine[:3, 3])
    shape = tuple(int(number) for number in np.ceil(centre + (max(radii) + 2.0) / sides) + 1)
    distance = np.linalg.norm(places((shape[0], shape[1], shape[2]), affine), axis=-1)
    return LabelVolume.of(np.sum([distance <= radius for radius in radii], axis=0).astype(np.uint16), affine)


def centred(radius: float, sides: ArrayLike, turn: ArrayLike | None = None) -> NDArray[np.float64]:
    """The affine of a grid that holds a sphere of this radius around the origin, which is at no voxel's centre."""
    lengths = np.abs(np.asarray(sides, dtype=float))
    return affine_of(sides, turn, np.ceil((radius + 2.0) / lengths) + np.array([0.13, 0.27, 0.4]))


def ring(big: float, small: float, side: float) -> tuple[LabelVolume, NDArray[np.float64]]:
    """A torus about the z axis, label 5."""
    shape = (int(2 * (big + small) / side) + 5, int(2 * (big + small) / side) + 5, int(2 * small / side) + 5)
    affine = affine_of((side,) * 3, None, (np.array(shape) - 1) / 2 + 0.2)
    return LabelVolume.of(np.where(from_ring(places(shape, affine), big, small) <= 0, 5, 0).astype(np.uint16), affine), affine


def from_ring(points: NDArray[np.float64], big: float, small: float) -> Distances:
    """Signed distance (..., 3) -> (...) to the torus, negative inside."""
    around = np.hypot(points[..., 0], points[..., 1]) - big
    distance: Distances = np.hypot(around, points[..., 2]) - small
    return distance


def side_by_side() -> LabelVolume:
    """A ball of label 1 with a ball of label 2 in it that comes out of it, and a core of label 3 that comes out of that."""
    affine = centred(12.0, (1, 1, 1))
    centres = places((30, 30, 34), affine)
    labels = np.where(np.linalg.norm(centres, axis=-1) <= 12.0, 1, 0)
    labels[np.linalg.norm(centres - (5.5, 0, 0), axis=-1) <= 7.0] = 2
    labels[np.linalg.norm(centres - (8.3, 0, 0), axis=-1) <= 4.0] = 3
    return LabelVolume.of(labels.astype(np.uint16), affine)
