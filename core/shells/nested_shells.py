"""Nested shells below a skin: thin where anatomy is thin, apart everywhere, proven by the caller on the files."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.clearance import Clearance
from core.geometry.face_tree import FaceTree
from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.schema.shells import ShellsInputs
from core.shells.advance import Surroundings, advance
from core.shells.depth_field import limit_slope, target_depths
from core.shells.inward_shift import inward_shift
from core.shells.reach import measure_reach
from core.shells.sheet import Sheet
from core.shells.thinnest_stack import thinnest_stack

Floats = NDArray[np.float64]

REACH_SHARE = 0.9  # of the medial ball's radius may be used; the rest keeps the two sides of a thin part apart
SLOPE = 1.0  # steepest change of depth per length of skin
SPLIT = 0.75  # in thin parts a layer takes this share of the next deeper layer's depth ...
OUTERMOST_SHARE = 0.4  # ... or more if there are many, so that the outermost keeps this share of the deepest's
OWN_CLEARANCE_MM = 0.01  # between faces of one shell that share no corner
ON_TARGET = 0.05  # relative; the contract's tolerance
ROUNDING_MM = 3e-4  # float32 moves a coordinate of a body by less


@dataclass(frozen=True, eq=False, slots=True)
class Shell:
    """One layer as made. targets_mm, allowed_mm, depth_mm: (N,) per vertex asked for, allowed by the reach, reached."""

    name: str
    mesh: Mesh
    targets_mm: Floats
    allowed_mm: Floats
    depth_mm: Floats


def create_shells(skin: Mesh, inputs: ShellsInputs, run: RunContext = SILENT) -> tuple[Shell, ...]:
    """Make the layers below a skin, outermost first.

    Needs:    a skin that `require_fit_skin` accepts, coordinates exact in float32.
    Promises: closed manifolds of the skin's genus, coordinates exact in float32; shells keep `min_gap_mm` from each other and the
              skin, and are free of self-intersection as far as float64 can tell (prove it exactly on the files).
    Raises:   InputError `layer.deeper_than_reach`, `skin.too_thin` (policy `fail`), `shells.no_room`, `region.*`.
    Source:   thesis ch. 4-6; method in docs/algorithms/shells.md.
    """
    run.stage("shells: depth field", 0.0, 0.05)
    targets = target_depths(skin.vertices, inputs.layers, inputs.regions)
    whole = Sheet.copy_of(skin.vertices, skin.faces)
    normals = vertex_normals(skin.vertices, skin.faces, "area")
    reach = measure_reach(skin.vertices, skin.faces, normals, largest_mm=2.0 * float(targets.max()) / REACH_SHARE)
    usable = limit_slope(REACH_SHARE * reach, skin.vertices, whole.net.neighbours, SLOPE)
    allowed = np.minimum(targets, usable)
    _require_reachable(skin, inputs, targets, usable)
    if inputs.thin_policy == "fail":
        _require_thick_enough(skin, inputs, targets, usable)

    own = min(OWN_CLEARANCE_MM, inputs.min_gap_mm)
    gap = inputs.min_gap_mm + ROUNDING_MM
    names = tuple(layer.name for layer in inputs.layers)
    stack = thinnest_stack(skin, whole, names, gap, own, run.stage("shells: thinnest stack", 0.05, 0.1))
    return _place_layers(skin, whole, inputs, targets, allowed, stack, Clearance(gap, own, ()), run)


def _place_layers(
    skin: Mesh,
    whole: Sheet,
    inputs: ShellsInputs,
    targets: Floats,
    allowed: Floats,
    stack: tuple[Sheet, ...],
    clearance: Clearance,
    run: RunContext,
) -> tuple[Shell, ...]:
    """Deepest layer first, each between the thinnest form of the one outside it and the finished one inside it."""
    shift = inward_shift(skin.vertices, skin.faces, whole.net.faces_around)
    tree = FaceTree.of(skin.vertices, skin.faces)
    shells: list[Shell] = []
    inner: tuple[FaceTree, Floats] | None = None
    for row in reversed(range(len(stack))):
        name, done, width = inputs.layers[row].name, len(stack) - 1 - row, 0.9 / len(stack)
        stage = run.stage(f"shells: {name}", 0.1 + done * width, 0.1 + (done + 1) * width)
        obstacles = [tree if row == 0 else FaceTree.of(stack[row - 1].vertices, stack[row - 1].net.faces)]
        depth = allowed[row]
        if inner is not None:
            obstacles.append(inner[0])
            share = np.maximum(_split(len(stack)), targets[row] / targets[row + 1])
            depth = np.minimum(depth, share * inner[1])
        around = Surroundings(tree, replace(clearance, obstacles=tuple(obstacles)))
        origin = stack[row].origin
        goal = skin.vertices[origin] + depth[origin, None] * shift[origin]
        sheet = advance(stack[row], goal, depth, around, stage)
        mesh = Mesh.of(sheet.vertices, sheet.net.faces).rounded_to_float32()
        reached, _away = around.depth(mesh.vertices)
        shells.append(Shell(name, mesh, targets[row][sheet.origin], depth[sheet.origin], reached))
        # not the rounded mesh: it may be nearer to the next layer's start by the rounding
        inner = FaceTree.of(sheet.vertices, sheet.net.faces), reached[sheet.stand_in]
    return tuple(reversed(shells))


def _split(layers: int) -> float:
    return max(SPLIT, float(OUTERMOST_SHARE ** (1 / max(layers - 1, 1))))


def _require_reachable(skin: Mesh, inputs: ShellsInputs, targets: Floats, usable: Floats) -> None:
    """A layer that can be kept nowhere is a mistake in the request, not thin anatomy; the place with most room is named."""
    for row, layer in enumerate(inputs.layers):
        if not (usable >= (1 - ON_TARGET) * targets[row]).any():
            deepest = float(usable.max())
            raise InputError(
                "layer.deeper_than_reach",
                f"layer '{layer.name}' at {layer.depth_mm:g} mm lies deeper than the body allows anywhere: {deepest:.3g} mm",
                findings=(
                    Finding(
                        code="layer.deeper_than_reach",
                        severity=Severity.ERROR,
                        message=f"the most room for layer '{layer.name}' is {deepest:.3g} mm, here",
                        count=len(skin.faces),
                        places=_places(skin, np.flatnonzero((skin.faces == usable.argmax()).any(axis=1))),
                    ),
                ),
                layer=layer.name,
                depth_mm=layer.depth_mm,
                deepest_mm=round(deepest, 4),
            )


def _require_thick_enough(skin: Mesh, inputs: ShellsInputs, targets: Floats, usable: Floats) -> None:
    for row, layer in enumerate(inputs.layers):
        thin = usable < (1 - ON_TARGET) * targets[row]
        if thin.any():
            faces = np.flatnonzero(thin[skin.faces].any(axis=1))
            thinnest = float(usable[thin].min())
            finding = Finding(
                code="skin.too_thin",
                severity=Severity.ERROR,
                message=f"layer '{layer.name}' does not fit at {layer.depth_mm:g} mm; the least room is {thinnest:.3g} mm",
                count=len(faces),
                places=_places(skin, faces),
            )
            raise InputError(
                "skin.too_thin",
                f"at {len(faces)} of {len(skin.faces)} faces the skin is too thin for layer '{layer.name}' at "
                f"{layer.depth_mm:g} mm (least room {thinnest:.3g} mm) and thin_policy is 'fail'; 'adapt' fades the depth there",
                findings=(finding,),
                layer=layer.name,
                faces=len(faces),
                least_room_mm=round(thinnest, 4),
            )


def _places(skin: Mesh, faces: NDArray[np.int64]) -> tuple[Place, ...]:
    """The first faces as places of the skin."""
    named = faces[:MAX_PLACES]
    centres = skin.triangles()[named].mean(axis=1)
    return tuple(
        Place(mesh="skin", point_mm=(float(x), float(y), float(z)), faces=(int(face),))
        for face, (x, y, z) in zip(named, centres, strict=True)
    )
