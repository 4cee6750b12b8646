"""Which way a body stands: height, side and front, found from the shape alone, in any axis convention."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.section import Plane, cut
from core.mesh import Mesh

Floats = NDArray[np.float64]
SAMPLED_VERTICES = 2000
SAMPLED_NEIGHBOURS = 40_000
SMALLEST_SIZE_MM = 1e-9
NEARLY_AS_LONG = 0.8
SHORTEST_PERSON_MM, TALLEST_PERSON_MM = 400.0, 2500.0
SLICES_FROM_END = (0.04, 0.07, 0.10, 0.13)
FLATTEST_PERSON = 0.45  # front-to-back extent over height of a standing person, arms forward included


@dataclass(frozen=True, slots=True)
class BodyFrame:
    """Unit vectors along the coordinate axes. `right` is the viewer's right who faces the front: up = front x right.

    is_person: two legs at one end and a head at the other were found, so `up` and `front` are the body's own;
    otherwise they are the positive axes and only name a direction of view.
    """

    right: Floats
    up: Floats
    front: Floats
    low: Floats
    high: Floats
    is_person: bool

    def height_mm(self) -> float:
        """Extent along `up`."""
        return float(self.high @ np.abs(self.up) - self.low @ np.abs(self.up))

    def level(self, share: float) -> float:
        """Coordinate along `up` of a share of the height, 0 at the lower end."""
        heights = sorted((float(self.low @ self.up), float(self.high @ self.up)))
        return heights[0] + share * (heights[1] - heights[0])

    def centre(self) -> Floats:
        """Middle of the bounding box, (3,) mm."""
        middle: Floats = (self.low + self.high) / 2
        return middle


def find_body_frame(mesh: Mesh) -> BodyFrame:
    """The frame of a mesh: height is its longest axis (the least symmetric among nearly equal ones, so that a T-pose is
    found too), side the more mirror-symmetric of the others; the head is where the midline is solid near the end, the
    front where the toes point."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    extents = high - low
    asymmetry = _asymmetries(mesh.vertices)
    lengths = np.round(extents / max(float(extents.max()), SMALLEST_SIZE_MM), 2)
    long_axes = [axis for axis in range(3) if extents[axis] >= NEARLY_AS_LONG * extents.max()]
    # a tie goes to z for the height and to x for the side, as most programs have it
    height = max(long_axes, key=lambda axis: (round(asymmetry[axis], 2), lengths[axis], axis))
    others = [axis for axis in range(3) if axis != height]
    side = min(others, key=lambda axis: (round(asymmetry[axis], 2), -lengths[axis], axis))
    depth = 3 - height - side
    up, front = np.eye(3)[height], np.eye(3)[depth]
    is_person = False
    if SHORTEST_PERSON_MM < extents[height] < TALLEST_PERSON_MM and extents[depth] < FLATTEST_PERSON * extents[height]:
        at_low, at_high = (_end_of_body(mesh, height, side, upper) for upper in (False, True))
        is_person = {at_low, at_high} == {"head", "legs"}
        if is_person:
            up = up if at_high == "head" else -up
            front = front * _toes_direction(mesh, up, depth)
    return BodyFrame(np.cross(up, front), up, front, low, high, is_person)


def _asymmetries(vertices: Floats) -> list[float]:
    """For each axis the median distance from mirrored vertices to the shape, as a share of its size; 0: a mirror image."""
    size = max(float(np.ptp(vertices, axis=0).max()), SMALLEST_SIZE_MM)
    tree = cKDTree(vertices[:: max(1, len(vertices) // SAMPLED_NEIGHBOURS)])
    shares = []
    for axis in range(3):
        mirrored = vertices[:: max(1, len(vertices) // SAMPLED_VERTICES)].copy()
        mirrored[:, axis] = vertices[:, axis].min() + vertices[:, axis].max() - mirrored[:, axis]
        distances, _ = tree.query(mirrored)
        shares.append(float(np.median(distances)) / size)
    return shares


def _end_of_body(mesh: Mesh, height: int, side: int, upper: bool) -> Literal["head", "legs", "neither"]:
    """What slices near one end show: a contour across the mirror plane, or contours on both sides of it only."""
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    origin = (low + high) / 2
    heads = legs = 0
    for share in SLICES_FROM_END:
        inwards = share * (high - low)[height]
        origin[height] = high[height] - inwards if upper else low[height] + inwards
        contours = cut(mesh, Plane.of(origin, np.eye(3)[side], np.eye(3)[3 - height - side]))
        spans = [(float(contour.points[:, 0].min()), float(contour.points[:, 0].max())) for contour in contours]
        crosses = any(start < 0.0 < stop for start, stop in spans)
        heads += crosses
        legs += not crosses and any(stop < 0.0 for _, stop in spans) and any(start > 0.0 for start, _ in spans)
    if max(heads, legs) <= len(SLICES_FROM_END) // 2:
        return "neither"
    return "head" if heads > legs else "legs"


def _toes_direction(mesh: Mesh, up: Floats, depth: int) -> float:
    """+1 or -1: where along the depth axis the soles reach further from the ankles."""
    heights = mesh.vertices @ up
    share = (heights - heights.min()) / np.ptp(heights)
    ankles = mesh.vertices[(share > 0.05) & (share < 0.08), depth]
    soles = mesh.vertices[share < 0.03, depth]
    if not len(ankles) or not len(soles):
        return 1.0
    middle = (ankles.min() + ankles.max()) / 2
    return 1.0 if soles.max() - middle >= middle - soles.min() else -1.0
