"""The thinnest stack of layers that keeps the gap: where every layer starts, and what it falls back to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.clearance import Clearance, MovingSurface
from core.geometry.face_tree import FaceTree
from core.geometry.quality import quality
from core.mesh import Mesh
from core.run import RunContext
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.shells.advance import Surroundings, mend
from core.shells.inward_shift import inward_shift
from core.shells.reconnect import collapse_edges, shortest_sides, without_slivers
from core.shells.sheet import Sheet

Floats = NDArray[np.float64]

FIRST_PUSH = 1.1  # of the gap
HARDER = 1.25  # where that is not enough
ATTEMPTS = 60
SLIVER_QUALITY = 0.05  # a layer does not copy faces of the skin below this q
POOR_QUALITY = 0.2  # below, smoothing was seen to make room: a skin with arms set apart had 0.06
SLIVER_HEIGHT_MM = 0.1  # ... and lower than that
SLIVER_ROUNDS = 10
PATIENCE = 20  # attempts after which edges are collapsed also where pushing harder has not helped


def thinnest_stack(
    skin: Mesh, whole: Sheet, names: tuple[str, ...], gap_mm: float, own_mm: float, run: RunContext
) -> tuple[Sheet, ...]:
    """One sheet per layer, outermost first, each just below the one before.

    Where a crease compresses a sheet until its faces crowd each other, edges are collapsed; where it comes too near the
    sheet outside, it is pushed harder.
    Raises: InputError `shells.no_room` with the places, if that does not end.
    """
    stack = []
    outer, tree = whole, FaceTree.of(skin.vertices, skin.faces)
    for count, name in enumerate(names):
        outer = _next_sheet(skin, tree, outer, name, gap_mm, own_mm)
        stack.append(outer)
        run.advance((count + 1) / len(names), f"{name}: {len(outer.net.faces)} faces")
    return tuple(stack)


def _next_sheet(skin: Mesh, tree: FaceTree, outer: Sheet, name: str, gap_mm: float, own_mm: float) -> Sheet:
    outside = Clearance(gap_mm, own_mm, (FaceTree.of(outer.vertices, outer.net.faces),))
    alone = Clearance(gap_mm, own_mm, ())
    push = np.full(len(skin.vertices), FIRST_PUSH * gap_mm)  # by skin vertex: it survives collapses
    sheet = without_slivers(outer, SLIVER_QUALITY, SLIVER_HEIGHT_MM, SLIVER_ROUNDS)
    shift = inward_shift(sheet.vertices, sheet.net.faces, sheet.net.faces_around)
    placed = _pushed(sheet, push, shift)
    surface = MovingSurface(placed.vertices, placed.net.faces)
    asked = np.arange(len(placed.net.faces))
    least, where = placed, asked  # what is crowded when that is least; from there it spreads
    for attempt in range(ATTEMPTS):
        crowded = surface.find_crowded(placed.vertices, asked, outside)
        if len(crowded) == 0:
            return mend(placed, surface, outer, Surroundings(tree, outside))
        if len(crowded) < len(where):
            least, where = placed, crowded
        folded = surface.find_crowded(placed.vertices, crowded, alone)
        near = sheet.net.corners_of(np.setdiff1d(crowded, folded))
        push[sheet.origin[near]] *= HARDER
        squeezed = folded if attempt < PATIENCE else crowded
        around = sheet.net.faces_of(sheet.net.corners_of(squeezed))
        former_sheet = sheet
        sheet, former = collapse_edges(sheet, shortest_sides(sheet, around))
        shift = _carried_shift(sheet, former_sheet, former, shift)
        before, placed = placed, _pushed(sheet, push, shift)
        moved = (placed.vertices[placed.net.faces] != before.vertices[before.net.faces[former]]).any(axis=(1, 2))
        asked = np.flatnonzero(moved | np.isin(former, crowded))
        surface = surface.edited(placed.vertices, placed.net.faces, former)
    raise _no_room(skin, least, where, name, gap_mm)


def _carried_shift(sheet: Sheet, former_sheet: Sheet, former: NDArray[np.int64], shift: Floats) -> Floats:
    """Shifts of a sheet after collapses: found anew only where faces changed; former (F,): the old number of each face."""
    carried = shift[former_sheet.stand_in[sheet.origin]]
    before, after = former_sheet.vertices[former_sheet.net.faces[former]], sheet.vertices[sheet.net.faces]
    changed = np.flatnonzero(sheet.net.corners_of(np.flatnonzero((before != after).any(axis=(1, 2)))))
    carried[changed] = inward_shift(sheet.vertices, sheet.net.faces, sheet.net.faces_around, changed)
    return carried


def _pushed(sheet: Sheet, push: Floats, shift: Floats) -> Sheet:
    return sheet.at(sheet.vertices + push[sheet.origin, None] * shift)


def _no_room(skin: Mesh, sheet: Sheet, crowded: NDArray[np.int64], name: str, gap_mm: float) -> InputError:
    corners = sheet.origin[sheet.net.faces[crowded]]
    places = tuple(
        Place(mesh="skin", point_mm=(float(x), float(y), float(z)), vertices=tuple(int(v) for v in ids))
        for ids, (x, y, z) in zip(corners[:MAX_PLACES], skin.vertices[corners[:MAX_PLACES]].mean(axis=1), strict=True)
    )
    told = f"there is no room for layer '{name}' at a gap of {gap_mm:.3g} mm"
    lowest = float(quality(skin.vertices, skin.faces).min())
    slivers = f"better triangles may make room: `smooth` the skin, whose lowest quality is {lowest:.2g}; or " * (
        lowest < POOR_QUALITY
    )
    return InputError(
        "shells.no_room",
        f"at {len(crowded)} faces {told}; {slivers}ask for a smaller min_gap_mm or fewer layers",
        findings=(Finding(code="shells.no_room", severity=Severity.ERROR, message=told, count=len(crowded), places=places),),
        faces=len(crowded),
        layer=name,
        gap_mm=round(gap_mm, 6),
    )
