"""Nested shells inside and outside a skin: thin where anatomy is thin, apart everywhere, proven by the caller on the files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.clearance import Clearance
from core.geometry.face_tree import FaceTree
from core.geometry.normals import vertex_normals
from core.geometry.volume import signed_volumes
from core.mesh import Mesh, Vertices
from core.run import SILENT, RunContext
from core.schema.finding import Finding, Place, Severity
from core.schema.shells import Layer, ShellsInputs, Side
from core.shells.advance import Surroundings, advance
from core.shells.depth_field import NO_ARRAYS, limit_slope, target_depths
from core.shells.inward_shift import inward_shift
from core.shells.reach import measure_reach
from core.shells.room import require_reachable, require_thick_enough
from core.shells.sheet import Sheet
from core.shells.thinnest_stack import thinnest_stack

Floats = NDArray[np.float64]

REACH_SHARE = 0.9  # of the medial ball's radius may be used; the rest keeps the two sides of a thin part apart
SLOPE = 1.0  # steepest change of depth per length of skin
SPLIT = 0.75  # in thin parts a layer takes this share of the next deeper layer's depth ...
OUTERMOST_SHARE = 0.4  # ... or more if there are many, so that the outermost keeps this share of the deepest's
OWN_CLEARANCE_MM = 0.01  # between faces of one shell that share no corner
ROUNDING_MM = 3e-4  # float32 moves a coordinate of a body by less


@dataclass(frozen=True, eq=False, slots=True)
class Shell:
    """One layer as made. targets_mm, allowed_mm, depth_mm: (N,) per vertex asked for, allowed by the reach, reached."""

    name: str
    mesh: Mesh
    targets_mm: Floats
    allowed_mm: Floats
    depth_mm: Floats
    side: Side = "inside"


def create_shells(
    skin: Mesh, inputs: ShellsInputs, run: RunContext = SILENT, arrays: Mapping[str, Floats] = NO_ARRAYS
) -> tuple[Shell, ...]:
    """Make the layers inside and outside a skin, outermost first; the skin itself is not among them.

    Needs:    a skin that `require_fit_skin` accepts, coordinates exact in float32; arrays: name -> (V,) mm with the depths
              that layers refer to.
    Promises: closed manifolds of the skin's genus, coordinates exact in float32; shells keep `min_gap_mm` from each other and the
              skin, and are free of self-intersection as far as float64 can tell (prove it exactly on the files).
    Raises:   InputError `layer.*`, `skin.too_thin` (policy `fail`), `shells.no_room`, `region.*`.
    Source:   thesis ch. 4-6; method in docs/algorithms/shells.md.
    """
    run.stage("shells: depth field", 0.0, 0.02)
    targets = target_depths(skin.vertices, inputs.layers, inputs.regions, arrays)
    outside = sum(layer.side == "outside" for layer in inputs.layers)
    share = 0.02 + 0.98 * outside / len(inputs.layers)
    shells: tuple[Shell, ...] = ()
    if outside:
        # the same task seen from the other side: with the faces turned over, the room around the body is what has to be filled
        layers, wanted = inputs.layers[:outside][::-1], targets[:outside][::-1]
        around = _layers_below(_turned_over(skin), layers, wanted, inputs, run.stage("shells: outside", 0.02, share))
        shells = tuple(replace(shell, mesh=_turned_over(shell.mesh)) for shell in reversed(around))
    if outside < len(inputs.layers):
        run = run.stage("shells: inside", share, 1.0) if outside else run.stage("shells", 0.02, 1.0)
        shells += _layers_below(skin, inputs.layers[outside:], targets[outside:], inputs, run)
    return shells


def _turned_over(mesh: Mesh) -> Mesh:
    """The same surface with its faces looking the other way."""
    return Mesh.of(mesh.vertices, mesh.faces[:, ::-1])


def _layers_below(
    skin: Mesh, layers: tuple[Layer, ...], targets: Floats, inputs: ShellsInputs, run: RunContext
) -> tuple[Shell, ...]:
    """The layers on the side the skin's faces look away from, from the skin on; targets (L, V) mm."""
    run.stage("shells: room", 0.0, 0.03)
    whole = Sheet.copy_of(skin.vertices, skin.faces)
    usable = measure_room(skin, whole, largest_mm=float(targets.max()))
    require_reachable(skin, layers, targets, usable)
    if inputs.thin_policy == "fail":
        require_thick_enough(skin, layers, targets, usable)
    own = min(OWN_CLEARANCE_MM, inputs.min_gap_mm)
    gap = inputs.min_gap_mm + ROUNDING_MM
    names = tuple(layer.name for layer in layers)
    stage = run.stage("shells: thinnest stack", 0.03, 0.1)
    made = stage.checkpoint(
        "shells: thinnest stack",
        lambda: tuple(sheet.parts() for sheet in thinnest_stack(skin, whole, names, gap, own, stage)),
        *(skin, names, gap, own),
    )
    stack = tuple(Sheet.of_parts(*parts) for parts in made)
    return _place_layers(skin, whole, layers, targets, np.minimum(targets, usable), stack, Clearance(gap, own, ()), run)


def measure_room(skin: Mesh, whole: Sheet, largest_mm: float) -> Floats:
    """How deep a layer may lie below each vertex, (V,) mm: a share of the reach, fading smoothly; exact up to largest_mm."""
    normals = vertex_normals(skin.vertices, skin.faces, "area")
    reach = measure_reach(skin.vertices, skin.faces, normals, largest_mm=2.0 * largest_mm / REACH_SHARE)
    return limit_slope(REACH_SHARE * reach, skin.vertices, whole.net.neighbours, SLOPE)


def _place_layers(
    skin: Mesh,
    whole: Sheet,
    layers: tuple[Layer, ...],
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
    starts = tuple(sheet.parts() for sheet in stack)
    decided_by = (skin, layers, targets, allowed, starts, clearance.gap_mm, clearance.own_mm)
    for row in reversed(range(len(stack))):
        name, done, width = layers[row].name, len(stack) - 1 - row, 0.9 / len(stack)
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
        sheet = _advanced(stack[row], goal, depth, around, stage, (*decided_by, row))
        mesh = Mesh.of(sheet.vertices, sheet.net.faces).rounded_to_float32()
        _require_not_through(skin, mesh, name)
        reached, _away = around.depth(mesh.vertices)
        shells.append(Shell(name, mesh, targets[row][sheet.origin], depth[sheet.origin], reached, layers[row].side))
        # not the rounded mesh: it may be nearer to the next layer's start by the rounding
        inner = FaceTree.of(sheet.vertices, sheet.net.faces), reached[sheet.stand_in]
    return tuple(reversed(shells))


def _advanced(
    start: Sheet, goal: Vertices, depth_mm: Floats, around: Surroundings, run: RunContext, decided_by: tuple[object, ...]
) -> Sheet:
    """The costly step of a layer, resumable; `decided_by`: what start, goal, depth and surroundings were made of."""
    made = run.checkpoint("shells: layer", lambda: advance(start, goal, depth_mm, around, run).parts(), *decided_by)
    return Sheet.of_parts(*made)


def _require_not_through(skin: Mesh, layer: Mesh, name: str) -> None:
    """A layer of a body hardly thicker than the layer is deep may go through itself. Raises: InputError `shells.no_room`."""
    volumes = [signed_volumes(mesh.vertices, mesh.faces, np.zeros(len(mesh.faces), dtype=np.int64))[0] for mesh in (skin, layer)]
    if volumes[0] * volumes[1] > 0:
        return
    told = f"there is no room for layer '{name}': the body is too thin to hold it anywhere"
    x, y, z = (float(value) for value in skin.vertices.mean(axis=0))
    places = (Place(mesh="skin", point_mm=(x, y, z), faces=(0,)),)
    finding = Finding(code="shells.no_room", severity=Severity.ERROR, message=told, count=len(skin.faces), places=places)
    raise InputError("shells.no_room", told, findings=(finding,), layer=name)


def _split(layers: int) -> float:
    return max(SPLIT, float(OUTERMOST_SHARE ** (1 / max(layers - 1, 1))))
