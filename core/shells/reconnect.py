"""Change the connectivity where a layer is compressed: flip and collapse edges under the same clearance as every step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.geometry.clearance import Clearance, MovingSurface
from core.geometry.connectivity import Connectivity
from core.geometry.normals import face_areas
from core.geometry.quality import quality, side_lengths
from core.shells.edge_choice import choose_collapses, choose_flips
from core.shells.innate_quality import find_poor
from core.shells.sheet import Sheet

Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

ATTEMPTS = 6  # a batch is tried again without the edges whose new faces were crowded


@dataclass(frozen=True, slots=True)
class Remedy:
    """Faces with q below these have their longest side flipped or their shortest side collapsed, where that helps."""

    flip_below: float = 0.3
    collapse_below: float = 0.2


@dataclass(frozen=True, eq=False, slots=True)
class _Change:
    """A sheet after a batch of edits: the faces that are new (K,), and the candidate behind each (K,).

    former: (F,) the number each face had before.
    """

    sheet: Sheet
    former: Ints
    faces: Ints
    candidate: Ints


def reconnect(
    sheet: Sheet, surface: MovingSurface, clearance: Clearance, remedy: Remedy, innate: Floats
) -> tuple[Sheet, MovingSurface, int]:
    """Flip the longest sides of caps, then collapse the shortest sides of needles.

    Promises: closed manifold, genus and clearance are kept; the lowest quality around a changed edge rises or stays.
    Returns the sheet, the tree that follows it, and how many edges changed.
    """
    shape = quality(sheet.vertices, sheet.net.faces)
    sides = side_lengths(sheet.vertices, sheet.net.faces)
    caps = find_poor(sheet, shape, remedy.flip_below, innate)
    caps = caps[np.argsort(shape[caps], kind="stable")]
    # side i of side_lengths lies opposite corner i, so it begins at corner i + 1
    begins = (np.argmax(sides[caps], axis=1) + 1) % 3
    flipped = _in_batches(len(caps), surface, clearance, lambda allowed: _flip(sheet, caps, begins, allowed))
    if flipped is not None:
        sheet, surface = flipped[0], flipped[1]

    after_flips = sheet
    shape = quality(sheet.vertices, sheet.net.faces)
    edges = shortest_sides(sheet, find_poor(sheet, shape, remedy.collapse_below, innate))
    collapsed = _in_batches(len(edges), surface, clearance, lambda allowed: _collapse(after_flips, edges, allowed, strict=True))
    if collapsed is not None:
        sheet, surface = collapsed[0], collapsed[1]
    return sheet, surface, sum(result[2] for result in (flipped, collapsed) if result is not None)


def without_slivers(sheet: Sheet, below: float, height_mm: float, rounds: int) -> Sheet:
    """The sheet with its slivers flipped or collapsed away as far as that goes; clearance is the caller's business.

    A sliver has a q below `below` and is lower than `height_mm`: what is long and thin by design, the rim of a plate say, stays.
    Keeps closed manifold and genus, turns no face over, lowers no quality.
    """
    for _ in range(rounds):
        slivers = _find_slivers(sheet, below, height_mm)
        if len(slivers) == 0:
            break
        change = _collapse(sheet, edges := shortest_sides(sheet, slivers), np.ones(len(edges), dtype=np.bool_), strict=True)
        sheet = sheet if change is None else change.sheet
        slivers = _find_slivers(sheet, below, height_mm)
        begins = (np.argmax(side_lengths(sheet.vertices, sheet.net.faces[slivers]), axis=1) + 1) % 3
        flipped = _flip(sheet, slivers, begins, np.ones(len(slivers), dtype=np.bool_))
        sheet = sheet if flipped is None else flipped.sheet
        if change is None and flipped is None:
            break
    return sheet


def _find_slivers(sheet: Sheet, below: float, height_mm: float) -> Ints:
    faces = np.flatnonzero(quality(sheet.vertices, sheet.net.faces) < below)
    longest = side_lengths(sheet.vertices, sheet.net.faces[faces]).max(axis=1)
    heights = 2.0 * face_areas(sheet.vertices, sheet.net.faces[faces]) / np.maximum(longest, 1e-300)
    found: Ints = faces[heights < height_mm]
    return found


def collapse_edges(sheet: Sheet, edges: Ints) -> tuple[Sheet, Ints]:
    """Collapse as many of the edges (E, 2) as may be at once, to their middles, in the order given.

    Keeps closed manifold and genus and turns no face over; quality and clearance are the caller's business.
    Returns the sheet and the former number of each of its faces.
    """
    change = _collapse(sheet, edges, np.ones(len(edges), dtype=np.bool_), strict=False)
    return (sheet, np.arange(len(sheet.net.faces))) if change is None else (change.sheet, change.former)


def shortest_sides(sheet: Sheet, faces: Ints) -> Ints:
    """The shortest side of each face, (K, 2) vertices, shortest first, none twice."""
    lengths = side_lengths(sheet.vertices, sheet.net.faces[faces])
    side = np.argmin(lengths, axis=1)
    rows = np.arange(len(faces))
    ends = np.column_stack((sheet.net.faces[faces, (side + 1) % 3], sheet.net.faces[faces, (side + 2) % 3])).astype(np.int64)
    order = np.argsort(lengths[rows, side], kind="stable")
    ends = np.sort(ends[order], axis=1)
    _unique, first = np.unique(ends, axis=0, return_index=True)
    return ends[np.sort(first)]


def _in_batches(
    count: int, surface: MovingSurface, clearance: Clearance, edit: Callable[[Flags], _Change | None]
) -> tuple[Sheet, MovingSurface, int] | None:
    """Apply all candidates that `edit` can combine; drop those that crowd and try again. None if nothing could be done."""
    allowed = np.ones(count, dtype=np.bool_)
    for _ in range(ATTEMPTS):
        change = edit(allowed) if allowed.any() else None
        if change is None:
            return None
        edited = surface.edited(change.sheet.vertices, change.sheet.net.faces, change.former)
        crowded = edited.find_crowded(change.sheet.vertices, change.faces, clearance)
        if len(crowded) == 0:
            return change.sheet, edited, len(np.unique(change.candidate))
        guilty = change.sheet.net.corners_of(crowded)[change.sheet.net.faces[change.faces]].any(axis=1)
        # only what was tried and was not guilty: others would bring new trouble
        tried = np.zeros(count, dtype=np.bool_)
        tried[change.candidate] = True
        allowed &= tried
        allowed[change.candidate[guilty]] = False
    return None


def _flip(sheet: Sheet, faces: Ints, begins: Ints, allowed: Flags) -> _Change | None:
    net = sheet.net
    partner = np.full(len(faces), -1, dtype=np.int64)
    choose_flips(
        sheet.vertices, net.faces, net.faces_around.start, net.faces_around.values,
        net.neighbours.start, net.neighbours.values, faces, begins, allowed, partner,
    )  # fmt: skip
    chosen = np.flatnonzero(partner >= 0)
    if len(chosen) == 0:
        return None
    first, second, at = faces[chosen], partner[chosen], begins[chosen]
    u, v, tip = (net.faces[first, (at + turn) % 3] for turn in range(3))
    opposite = net.faces[second].sum(axis=1) - u - v
    flipped = net.faces.copy()
    flipped[first] = np.column_stack((u, opposite, tip))
    flipped[second] = np.column_stack((opposite, v, tip))
    changed = replace(sheet, net=Connectivity.of(flipped, net.vertex_count))
    same = np.arange(len(net.faces))
    return _Change(changed, same, np.concatenate((first, second)), np.concatenate((chosen, chosen)))


def _collapse(sheet: Sheet, edges: Ints, allowed: Flags, *, strict: bool) -> _Change | None:
    net = sheet.net
    chosen, places = np.zeros(len(edges), dtype=np.bool_), np.empty((len(edges), 3))
    choose_collapses(
        sheet.vertices, net.faces, net.faces_around.start, net.faces_around.values,
        net.neighbours.start, net.neighbours.values, edges, allowed, strict, chosen, places,
    )  # fmt: skip
    number = np.flatnonzero(chosen)
    if len(number) == 0:
        return None
    gone, kept = edges[number, 1], edges[number, 0]
    merged, former = sheet.merged(gone, kept, places[number])
    # a vertex's stand-in tells where the kept one went
    candidate_at = np.full(merged.net.vertex_count, -1, dtype=np.int64)
    candidate_at[merged.stand_in[sheet.origin[kept]]] = number
    candidate_of_face = candidate_at[merged.net.faces].max(axis=1)
    faces = np.flatnonzero(candidate_of_face >= 0)
    return _Change(merged, former, faces, candidate_of_face[faces])
