"""Move the skin outwards, within a bound, where the body is too thin for the layers below it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InternalError
from core.geometry.clearance import Clearance, MovingSurface
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.normals import face_crosses, vertex_normals
from core.geometry.quality import quality
from core.mesh import Mesh, Vertices
from core.run import SILENT, RunContext
from core.schema.shells import ShellsInputs
from core.shells.depth_field import NO_ARRAYS, limit_slope, target_depths
from core.shells.inward_shift import inward_shift
from core.shells.nested_shells import OWN_CLEARANCE_MM, REACH_SHARE
from core.shells.reach import measure_reach
from core.shells.sheet import Sheet

Floats = NDArray[np.float64]

ROUNDS = 4
SHIFT_SLOPE = 0.5  # steepest change of the movement per length of skin
AIR_SHARE = 0.5  # of the free ball outside may be used, so that two parts facing each other leave some air
ROOM_SHARE = 2.5  # gaps per layer outside that parts of the skin keep from each other, so that the layers fit in between
RETREAT = 0.6  # a crowded vertex falls back to this share of its way
MOST_RETREATS = 60
LEAST_QUALITY = 0.05  # q below which no face is squeezed ...
LOST_QUALITY = 0.8  # ... or this share of its q, where that is less
WORTH_MM = 0.01  # no further round for less


@dataclass(frozen=True, eq=False, slots=True)
class WidenedSkin:
    """The skin to go on with. moved_mm: (V,) how far each vertex is from where it was."""

    mesh: Mesh
    moved_mm: Floats


def widen_skin(
    skin: Mesh, inputs: ShellsInputs, arrays: Mapping[str, Floats] = NO_ARRAYS, run: RunContext = SILENT
) -> WidenedSkin:
    """Give thin parts the thickness that the deepest layer inside asks for, as far as `skin_shift_mm` allows.

    Needs:    a skin that `require_fit_skin` accepts, coordinates exact in float32.
    Promises: same connectivity, coordinates exact in float32, no self-intersection (exact); no vertex moved by more than the
              bound, none at all where the reach suffices: those keep their bits. No face turned over.
    Raises:   InputError `layer.*`, `region.*`; InternalError `skin.shift_not_proven`.
    Source:   thesis 5.2.3, where the outer shell was moved outwards by hand; method in docs/algorithms/shells.md.
    """
    inside = [layer.side == "inside" for layer in inputs.layers]
    if inputs.skin_shift_mm == 0 or not any(inside):
        return WidenedSkin(skin, np.zeros(len(skin.vertices)))
    deepest = target_depths(skin.vertices, inputs.layers, inputs.regions, arrays)[inside][-1]
    whole = Sheet.copy_of(skin.vertices, skin.faces)
    around = inside.count(False)
    own = ROOM_SHARE * inputs.min_gap_mm * max(around, 1) + min(OWN_CLEARANCE_MM, inputs.min_gap_mm)
    lacking = _lacking(skin, deepest)
    thin = lacking > 0
    asked, moved = lacking, skin
    for count in range(ROUNDS):
        goal = _goal(skin, whole, asked, inputs.skin_shift_mm)
        moved = skin.with_vertices(_advance(skin, whole, goal, Clearance(inputs.min_gap_mm, own, ()))).rounded_to_float32()
        # where the other side of a thin part does not move as well, half of what is asked for is gained
        lacking = _lacking(moved, deepest)
        run.advance((count + 1) / ROUNDS, f"round {count + 1}: {int((lacking > WORTH_MM).sum())} vertices too thin")
        if not (lacking[thin] > WORTH_MM).any():
            break
        asked = np.where(thin, asked + lacking, 0.0)
    distance = np.linalg.norm(moved.vertices - skin.vertices, axis=1)
    _prove(moved, distance, inputs.skin_shift_mm)
    return WidenedSkin(moved, distance)


def _lacking(skin: Mesh, depth_mm: Floats) -> Floats:
    """By how much the medial ball at each vertex is too small for the deepest layer, (V,) mm."""
    normals = vertex_normals(skin.vertices, skin.faces, "area")
    reach = measure_reach(skin.vertices, skin.faces, normals, largest_mm=2.0 * float(depth_mm.max()) / REACH_SHARE)
    lacking: Floats = np.maximum(depth_mm / REACH_SHARE - reach, 0.0)
    return lacking


def _goal(skin: Mesh, whole: Sheet, asked: Floats, bound_mm: float) -> Vertices:
    """Where the vertices shall go, (V, 3): the movement fades to nothing at the border of what is thin, and leaves some air."""
    outside = skin.faces[:, ::-1]
    normals = vertex_normals(skin.vertices, outside, "area")
    air = measure_reach(skin.vertices, outside, normals, largest_mm=2.0 * bound_mm / AIR_SHARE)
    # rounding to float32 may add to the distance: by less than this
    rounding = float(np.sqrt(3.0) * 2.0**-24 * (np.abs(skin.vertices).max() + bound_mm))
    bound = max(bound_mm - rounding, 0.0)
    shift = np.minimum(np.minimum(asked, AIR_SHARE * air), bound)
    shift = limit_slope(shift, skin.vertices, whole.net.neighbours, SHIFT_SLOPE)
    step: Floats = shift[:, None] * inward_shift(skin.vertices, outside, whole.net.faces_around)
    # the way that shifts all faces around a crease alike is longer than the shift itself
    too_long = np.maximum(np.linalg.norm(step, axis=1) / max(bound, 1e-300), 1.0)
    goal: Vertices = skin.vertices + step / too_long[:, None]
    return goal


def _advance(skin: Mesh, whole: Sheet, goal: Vertices, clearance: Clearance) -> Vertices:
    """As far towards the goal as the skin can go without coming too near itself, turning a face over or squeezing it.

    Faces that crowd each other from the outset stay where they are.
    """
    net = whole.net
    surface = MovingSurface(skin.vertices, skin.faces)
    everything = np.arange(len(skin.faces))
    share = np.ones(len(skin.vertices))
    share[net.corners_of(surface.find_crowded(skin.vertices, everything, clearance))] = 0.0
    before = face_crosses(skin.vertices, skin.faces)
    least = np.minimum(LEAST_QUALITY, LOST_QUALITY * quality(skin.vertices, skin.faces))
    way = share[:, None] * (goal - skin.vertices)
    travelling = (way != 0).any(axis=1)
    moving = net.faces_of(travelling)
    asked = moving
    for attempt in range(MOST_RETREATS):
        vertices = skin.vertices + share[:, None] * way
        turned = np.einsum("ij,ij->i", before[asked], face_crosses(vertices, skin.faces[asked])) <= 0
        squeezed = quality(vertices, skin.faces[asked]) < least[asked]
        broken = np.union1d(surface.find_crowded(vertices, asked, clearance), asked[turned | squeezed])
        if len(broken) == 0:
            return vertices
        back = net.grown(net.corners_of(broken)) & travelling
        share[back] *= RETREAT if attempt < MOST_RETREATS // 2 else 0.0
        asked = np.union1d(net.faces_of(back), np.intersect1d(broken, moving))
    return skin.vertices


def _prove(moved: Mesh, distance: Floats, bound_mm: float) -> None:
    """On what the files will hold. Raises: InternalError `skin.shift_not_proven`."""
    crossing = len(find_intersecting_faces(moved.vertices, moved.faces))
    if crossing or distance.max() > bound_mm:
        raise InternalError(
            "skin.shift_not_proven",
            f"the moved skin has {crossing} intersecting faces and lies {distance.max():.6g} mm from the given one at most, "
            f"{bound_mm:g} mm are allowed",
            intersecting=crossing,
            largest_mm=float(distance.max()),
        )
