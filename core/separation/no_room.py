"""The refusal when tissues cannot be brought apart: which ones, where, what stands in the way, and how fine faces must be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import zip_longest

import numpy as np

from core.errors import InputError
from core.mesh import Mesh
from core.schema.finding import MAX_PLACES, Finding, Severity
from core.schema.separate import SeparateInputs
from core.separation.edge_needed import EdgeNeeded, find_edge_needed
from core.separation.opening import Closeness
from core.separation.relations import Relation
from core.separation.tissue import Tissue
from core.validation.measure import significant
from core.validation.places import face_places, vertex_places

MAX_MEASURED = 5  # pairs, the worst, of which it is told how fine they would have to be
WORDS: Mapping[Relation, str] = {"inside": "inside", "around": "around", "beside": "beside"}


def no_room(
    tissues: Mapping[str, Tissue],
    came: Mapping[str, Mesh],
    left: Sequence[Closeness],
    relations: Mapping[tuple[str, str], Relation],
    inputs: SeparateInputs,
) -> InputError:
    """InputError `separate.no_room` with one finding for every pair that is still too close, the worst first.

    came: surfaces as they came, before any face was halved."""
    worst_first = sorted(left, key=lambda closeness: -_size(closeness))
    needed = [
        find_edge_needed(came[one.a], came[one.b], relations[one.a, one.b], inputs.min_gap_mm)
        for one in worst_first[:MAX_MEASURED]
    ]
    findings = tuple(
        _finding(tissues, closeness, relations[closeness.a, closeness.b], edge)
        for closeness, edge in zip_longest(worst_first, needed)
    )
    finest = min((edge.edge_mm for edge in needed if edge is not None), default=None)
    error = InputError(
        "separate.no_room",
        f"a gap of {inputs.min_gap_mm:g} mm could not be opened everywhere: {findings[0].message}; allow a larger "
        f"`max_shift_mm` or let more surfaces move{_finer(finest)}",
        findings=findings,
        pairs=len(left),
        min_gap_mm=inputs.min_gap_mm,
        max_shift_mm=inputs.max_shift_mm,
    )
    if finest is not None:
        error.facts["edge_needed_mm"] = significant(finest)
    return error


def _finer(edge_mm: float | None) -> str:
    if edge_mm is None:
        return ""
    return (
        f", or take finer surfaces, edges of at most {edge_mm:.2g} mm there, from where these came from: what was thinned out "
        "one by one has lost the room between its folds"
    )


def _size(closeness: Closeness) -> int:
    return sum(len(contact.faces) for contact in closeness.contacts) + sum(len(wrong) for wrong in closeness.wrong)


def _finding(tissues: Mapping[str, Tissue], closeness: Closeness, relation: Relation, needed: EdgeNeeded | None) -> Finding:
    a, b = closeness.a, closeness.b
    places = []
    for name, contact, wrong in zip((a, b), closeness.contacts, closeness.wrong, strict=True):
        mesh = tissues[name].original
        closest = contact.faces[np.argsort(contact.distance_mm, kind="stable")][: MAX_PLACES // 2]
        places += [*face_places(name, mesh, closest), *vertex_places(name, mesh, wrong[: MAX_PLACES // 2 - len(closest)])]
    faces = sum(len(contact.faces) for contact in closeness.contacts)
    stuck = [name for name in (a, b) if not tissues[name].movable]
    why = f"{' and '.join(stuck)} fixed" if stuck else "all room around them used up"
    return Finding(
        code="separate.no_room",
        severity=Severity.ERROR,
        message=f"{a}, {WORDS[relation]} {b}, stays too close at {faces} faces ({why}){_edges(needed)}",
        count=_size(closeness),
        places=tuple(places[:MAX_PLACES]),
    )


def _edges(needed: EdgeNeeded | None) -> str:
    if needed is None:
        return ""
    return (
        f"; they came {needed.depth_mm:.2g} mm deep in one another with edges up to {needed.longest_mm:.3g} mm there, and could "
        f"follow each other with {needed.edge_mm:.2g} mm"
    )
