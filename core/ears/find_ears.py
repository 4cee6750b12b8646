"""Both ears of a human surface: the thin sheets that stand out at the sides of the head."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.ears.thin_sheets import find_thin_sheets
from core.errors import InputError
from core.geometry.body_frame import BodyFrame, find_body_frame
from core.geometry.components import label_connected
from core.geometry.normals import vertex_normals
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# shares of the stature
HEAD_ABOVE = 0.86
EARS_BETWEEN = (0.87, 0.97)
WIDEST_HEAD = 0.16
THINNEST_HEAD_WALL = 0.0075  # a pinna is thinner than this, what else is at the side of the head is not
JOINED_WITHIN = 0.005
BESIDE = 0.7  # an ear lies outside this share of the head's half width; eyelids, lips and nostrils do not
FEWEST_VERTICES = 12
HEIGHT_MM = (30.0, 90.0)
WIDEST_FOR_HEIGHT = 1.2  # front to back, and sideways, over height
FROM_MIDDLE = 0.25  # front to back, of the depth of the head: eyes and nose are farther in front
UNEQUAL_BY = 0.35  # of the larger ear's height: of a pair, in size and in place
MARGIN_MM = 3.0


@dataclass(frozen=True, slots=True)
class Ear:
    """One ear: its name from the body's own view, the box round its pinna (3,), (3,) mm and the direction out of the head."""

    name: str
    low: Floats
    high: Floats
    outward: Floats

    def holds(self, points: Floats) -> NDArray[np.bool_]:
        """Points (N, 3) inside the box."""
        return np.asarray(((points >= self.low) & (points <= self.high)).all(axis=1))


def find_ears(skin: Mesh) -> tuple[Ear, Ear]:
    """The left and the right ear.

    Needs:    a whole body along the coordinate axes, standing or lying, its sides told apart as in nature (not mirrored).
    Promises: a mirror-like pair at the sides of the head, 30 to 90 mm high, in boxes with 3 mm to spare.
    Raises:   InputError `ears.not_found`, with what was missing.
    """
    frame = find_body_frame(skin)
    if not frame.is_person:
        raise _not_found("the surface does not stand or lie like a person, along one of the axes, with a head and two legs")
    head = np.flatnonzero(skin.vertices @ frame.up > frame.level(HEAD_ABOVE))
    points = skin.vertices[head]
    across = points @ frame.right
    half_width = float(np.ptp(across)) / 2
    sideways = across - (across.min() + half_width)  # from the middle of the head, not of the body: it may lean
    if not 0.0 < 2.0 * half_width < WIDEST_HEAD * frame.height_mm():
        raise _not_found(
            f"its upper end is {2 * half_width:.0f} mm wide, which is no head for {frame.height_mm():.0f} mm of height"
        )
    normals = vertex_normals(skin.vertices, skin.faces, "area")[head]
    thin = find_thin_sheets(points, normals, THINNEST_HEAD_WALL * frame.height_mm())
    left, right = (
        _ear(name, points[thin & (side * sideways > BESIDE * half_width)], side * frame.right, frame, points)
        for name, side in (("left_ear", 1.0), ("right_ear", -1.0))
    )
    _require_pair(left, right, frame)
    return left, right


def _ear(name: str, points: Floats, outward: Floats, frame: BodyFrame, head: Floats) -> Ear:
    """The largest cluster of points as an ear, if it has the size and place of one on the head (N, 3)."""
    words = name.replace("_", " ")
    if len(points) < FEWEST_VERTICES:
        raise _not_found(f"there is no thin sheet standing out where the {words} should be")
    links = cKDTree(points).query_pairs(JOINED_WITHIN * frame.height_mm(), output_type="ndarray")
    _count, label = label_connected(len(points), links[:, 0], links[:, 1])
    pinna = points[label == np.bincount(label).argmax()]
    size = np.ptp(pinna, axis=0)
    height, across = float(size @ np.abs(frame.up)), float(max(size @ np.abs(frame.front), size @ np.abs(frame.right)))
    if not HEIGHT_MM[0] <= height <= HEIGHT_MM[1] or across > WIDEST_FOR_HEIGHT * height:
        raise _not_found(
            f"what stands out where the {words} should be is {height:.0f} mm high and {across:.0f} mm across; an ear is "
            f"{HEIGHT_MM[0]:g} to {HEIGHT_MM[1]:g} mm high and slimmer"
        )
    low, high = (frame.level(share) for share in EARS_BETWEEN)
    if not low <= float(pinna.mean(axis=0) @ frame.up) <= high:
        raise _not_found(f"what stands out where the {words} should be is not at the height of an ear")
    front, back = float((head @ frame.front).max()), float((head @ frame.front).min())
    if abs(float(pinna.mean(axis=0) @ frame.front) - (front + back) / 2) > FROM_MIDDLE * (front - back):
        raise _not_found(f"what stands out where the {words} should be is not at the side of the head")
    return Ear(name, pinna.min(axis=0) - MARGIN_MM, pinna.max(axis=0) + MARGIN_MM, outward)


def _require_pair(left: Ear, right: Ear, frame: BodyFrame) -> None:
    """Mirror images, roughly: nobody's ears differ by a third."""
    sizes = np.array([ear.high - ear.low - 2 * MARGIN_MM for ear in (left, right)])
    height = float((sizes @ np.abs(frame.up)).max())
    apart = (left.high + left.low - right.high - right.low) / 2
    in_place = max(abs(float(apart @ frame.up)), abs(float(apart @ frame.front)))
    in_size = float(np.abs(sizes[0] - sizes[1]).max())
    if max(in_place, in_size) > UNEQUAL_BY * height:
        raise _not_found(
            f"what stands out at the two sides of the head is no pair: {in_size:.0f} mm different in size, "
            f"{in_place:.0f} mm in place"
        )


def _not_found(reason: str) -> InputError:
    return InputError("ears.not_found", f"no two ears were found: {reason}. Give their boxes as `ears` instead of 'auto'")
