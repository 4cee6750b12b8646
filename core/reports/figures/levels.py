"""Where to cut: ears, midline, torso, hand and foot of a standing person, the three middle planes of anything else."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.geometry.body_frame import BodyFrame
from core.geometry.section import Plane
from core.mesh import Mesh

Floats = NDArray[np.float64]
# shares of the height of a standing adult; they choose a picture, no number depends on them
EARS_BETWEEN = (0.89, 0.97)
EAR_BESIDE = 0.75  # of the half width of the window
HEAD_ABOVE = 0.86
TORSO_AT = 0.70
HANDS_BESIDE_THIGHS_AT = 0.45
SPREAD_ARMS = 0.40
HAND_SIZE = 0.07
FINGERS_FROM_TIP = 0.018
TOES_FROM_TIP = 0.016
SOLES_BELOW = 0.06
MARGIN = 0.04
THINNEST = 0.2
SMALLEST_WINDOW_MM = 1e-3
FEWEST_VERTICES = 3
SLICE = 0.01


@dataclass(frozen=True, slots=True)
class Level:
    """A plane with its window (2,), (2,) in mm of the plane, and words for the title.

    absolute: the plane follows the mesh's axes and its coordinates are the mesh's own, up to their sign.
    zoom_from: (2,), the lower left corner of the part of the window in which a zoom is looked for."""

    title: str
    seen_from: str
    plane: Plane
    low: Floats
    high: Floats
    absolute: bool = True
    zoom_from: Floats | None = None


def find_levels(mesh: Mesh, frame: BodyFrame) -> dict[str, tuple[Level, ...]]:
    """Figure name -> its levels."""
    if not frame.is_person:
        return {"sections": _middle_levels(mesh, frame)}
    return {
        "sections_head": (_ears(mesh, frame), _midline_of_head(mesh, frame)),
        "sections_body": (_across(mesh, frame, "Torso", TORSO_AT), _hand(mesh, frame), _foot(mesh, frame)),
    }


def _middle_levels(mesh: Mesh, frame: BodyFrame) -> tuple[Level, ...]:
    right, up, front, centre = frame.right, frame.up, frame.front, frame.centre()
    planes = (Plane.of(centre, right, front), Plane.of(centre, right, up), Plane.of(centre, -front, up))
    return tuple(
        _level(f"Middle plane {_where(plane)}", f"from {axis_name(plane.normal)}", plane, mesh.vertices) for plane in planes
    )


def _ears(mesh: Mesh, frame: BodyFrame) -> Level:
    heights = mesh.vertices @ frame.up
    low, high = (frame.level(share) for share in EARS_BETWEEN)
    head = _vertices_where(mesh, (heights > low) & (heights < high))
    widest = head[int(np.argmax(np.abs((head - frame.centre()) @ frame.right)))]
    plane = _horizontal(frame, float(widest @ frame.up))
    level = _level(f"Head at the ears, {_where(plane)}", "from the feet", plane, head)
    middle = float(frame.centre() @ frame.right)
    left_ear = np.array([middle + EAR_BESIDE * (level.high[0] - middle), level.low[1]])
    return replace(level, zoom_from=left_ear)


def _midline_of_head(mesh: Mesh, frame: BodyFrame) -> Level:
    plane = Plane.of(frame.centre(), -frame.front, frame.up)
    head = _vertices_where(mesh, mesh.vertices @ frame.up > frame.level(HEAD_ABOVE))
    return _level(f"Head at the midline, {_where(plane)}", "from its right", plane, head)


def _across(mesh: Mesh, frame: BodyFrame, title: str, share: float) -> Level:
    """Everything at a share of the height."""
    plane = _horizontal(frame, frame.level(share))
    near = np.abs(mesh.vertices @ frame.up - frame.level(share)) < SLICE * frame.height_mm()
    return _level(f"{title}, {_where(plane)}", "from the feet", plane, _vertices_where(mesh, near))


def _hand(mesh: Mesh, frame: BodyFrame) -> Level:
    sideways = mesh.vertices @ frame.right
    if np.ptp(sideways) < SPREAD_ARMS * frame.height_mm():
        return _across(mesh, frame, "Hands and thighs", HANDS_BESIDE_THIGHS_AT)
    # across the fingers, whatever way the hand hangs
    tip = mesh.vertices[int(np.argmax(sideways))]
    near_tip = np.linalg.norm(mesh.vertices - tip, axis=1) < HAND_SIZE * frame.height_mm()
    hand = _vertices_where(mesh, near_tip)
    along = (tip - hand.mean(axis=0)) / np.linalg.norm(tip - hand.mean(axis=0))
    from_tip = FINGERS_FROM_TIP * frame.height_mm()
    plane = Plane.of(tip - from_tip * along, frame.front, np.cross(along, frame.front))
    low, high = _window(plane.flatten(hand[(hand - plane.origin) @ along > 0]), 2 * MARGIN)
    return Level(f"Fingers, {from_tip:.0f} mm from the longest tip", "along the hand", plane, low, high, absolute=False)


def _foot(mesh: Mesh, frame: BodyFrame) -> Level:
    sideways = (mesh.vertices - frame.centre()) @ frame.right
    foot = _vertices_where(mesh, (mesh.vertices @ frame.up < frame.level(SOLES_BELOW)) & (sideways > 0))
    forward = foot @ frame.front
    at = float(forward.max()) - TOES_FROM_TIP * frame.height_mm()
    plane = Plane.of(frame.front * at, frame.right, frame.up)
    return _level(f"Toes, {_where(plane)}", "from the front", plane, foot[forward > at])


def _vertices_where(mesh: Mesh, wanted: NDArray[np.bool_]) -> Floats:
    """The vertices wanted, (N, 3); all of them where a coarse mesh has next to none."""
    picked: Floats = mesh.vertices[wanted] if wanted.sum() >= FEWEST_VERTICES else mesh.vertices
    return picked


def _horizontal(frame: BodyFrame, at: float) -> Plane:
    return Plane.of(frame.up * at, frame.right, frame.front)


def _level(title: str, seen_from: str, plane: Plane, shown: Floats) -> Level:
    """The window holds the points shown; the origin moves to the foot point, so plane coordinates are mesh coordinates."""
    grounded = Plane(plane.normal * (plane.origin @ plane.normal), plane.right, plane.up)
    return Level(title, seen_from, grounded, *_window(grounded.flatten(shown), MARGIN))


def _window(flat: Floats, margin: float) -> tuple[Floats, Floats]:
    """Corners (2,), (2,) around points (N, 2), never thinner than THINNEST of the longer side."""
    low, high = flat.min(axis=0), flat.max(axis=0)
    longest = max(float((high - low).max()), SMALLEST_WINDOW_MM)
    grow = np.maximum(margin * longest, 0.5 * (THINNEST * longest - (high - low)))
    return low - grow, high + grow


def _where(plane: Plane) -> str:
    letter, sign = axis_of(plane.normal)
    return f"{letter} = {round(sign * float(plane.origin @ plane.normal))} mm".replace("-", "−")


def axis_of(direction: Floats) -> tuple[str, float]:
    """Letter and sign of the coordinate axis a unit vector is nearest to."""
    axis = int(np.argmax(np.abs(direction)))
    return "xyz"[axis], float(np.sign(direction[axis]))


def axis_name(direction: Floats) -> str:
    """`+x`, `-z` …"""
    letter, sign = axis_of(direction)
    return f"{'+' if sign > 0 else '−'}{letter}"
