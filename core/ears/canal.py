"""An ear canal as a solid of air, for users without a segmentation: a round tube in the shape of an S (thesis Figs. 57-61)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.mesh import Mesh

Floats = NDArray[np.float64]

AROUND = 20
LARGEST_BEND_OF_LENGTH = 0.25  # a tube bent more would run into itself
ROUNDING_RINGS = 4


def make_canal(
    entrance: ArrayLike,
    inward: ArrayLike,
    up: ArrayLike,
    *,
    radius_mm: float = 3.5,
    length_mm: float = 25.0,
    bend_mm: float = 2.0,
    outside_mm: float = 3.0,
    around: int = AROUND,
) -> Mesh:
    """A tube from `outside_mm` before the entrance to `length_mm` behind it, with rounded ends.

    entrance: (3,) mm, on the skin. inward: (3,) along which it runs. up: (3,) the direction in which it swings first by
    `bend_mm`, then back by as much: an S. around: corners of its cross-section.
    Promises: closed, outward, genus 0, triangles with sides near 2π radius / around.
    Raises:   ValueError for a bend that the radius and length do not allow.
    """
    if bend_mm > LARGEST_BEND_OF_LENGTH * length_mm or not 0 < radius_mm < length_mm / 2:
        raise ValueError(f"a tube of radius {radius_mm:g} mm and length {length_mm:g} mm cannot bend by {bend_mm:g} mm")
    along = np.asarray(inward, dtype=np.float64) / np.linalg.norm(inward)
    above = np.asarray(up, dtype=np.float64) - along * (np.asarray(up) @ along)
    above = above / np.linalg.norm(above)
    side = np.cross(along, above)
    places, radii = _profile(radius_mm, length_mm, outside_mm, 2 * np.pi * radius_mm / around)
    share = np.clip(places / length_mm, 0.0, 1.0)
    axis = np.asarray(entrance) + places[:, None] * along + (bend_mm * np.sin(2 * np.pi * share) * share)[:, None] * above
    rings = []
    for row, (centre, radius) in enumerate(zip(axis, radii, strict=True)):
        # every other ring is turned by half a corner: nearly equilateral triangles
        angles = 2 * np.pi * (np.arange(around) + 0.5 * (row % 2)) / around
        rings.append(centre + radius * (np.cos(angles)[:, None] * above + np.sin(angles)[:, None] * side))
    vertices = np.vstack([*rings, axis[0] - radii[0] * 0.3 * along, axis[-1] + radii[-1] * 0.3 * along])
    return Mesh.of(vertices, _faces(len(rings), around))


def _profile(radius_mm: float, length_mm: float, outside_mm: float, step_mm: float) -> tuple[Floats, Floats]:
    """Places along the axis (N,) and radii (N,) of the rings, rounded at both ends."""
    turns = np.linspace(np.pi / 8, np.pi / 2, ROUNDING_RINGS)
    first, last = -outside_mm + radius_mm, length_mm - radius_mm
    middle = np.linspace(first, last, max(3, round((last - first) / (0.87 * step_mm)) + 1))
    places = np.concatenate([first - radius_mm * np.cos(turns[:-1]), middle, last + radius_mm * np.cos(turns[:-1])[::-1]])
    radii = np.concatenate(
        [radius_mm * np.sin(turns[:-1]), np.full(len(middle), radius_mm), radius_mm * np.sin(turns[:-1])[::-1]]
    )
    return places, radii


def _faces(rings: int, around: int) -> NDArray[np.int32]:
    """Strips between rings, and a fan at each end; outward if the corners run counter-clockwise seen along the axis."""
    faces = []
    corner = np.arange(around)
    following = (corner + 1) % around
    for row in range(rings - 1):
        near, far = row * around, (row + 1) * around
        # the far ring leads by half a corner after even rows and trails after odd ones
        if row % 2 == 0:
            faces += [(near + corner, near + following, far + corner), (near + following, far + following, far + corner)]
        else:
            faces += [(near + corner, near + following, far + following), (near + corner, far + following, far + corner)]
    first, last = rings * around, rings * around + 1
    end = (rings - 1) * around
    faces += [
        (np.full(around, first), following, corner),
        (np.full(around, last), end + corner, end + following),
    ]
    stacked = np.vstack([np.column_stack(three) for three in faces])
    return stacked.astype(np.int32)
