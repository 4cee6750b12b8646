"""The refusal when tissues cannot be brought apart: which ones, where, and what stands in the way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from core.errors import InputError
from core.geometry.bisection import longest_edges
from core.schema.finding import MAX_PLACES, Finding, Severity
from core.schema.separate import SeparateInputs
from core.separation.opening import Closeness
from core.separation.relations import Relation
from core.separation.tissue import Tissue
from core.validation.places import face_places, vertex_places

WORDS: Mapping[Relation, str] = {"inside": "inside", "around": "around", "beside": "beside"}


def no_room(
    tissues: Mapping[str, Tissue],
    left: Sequence[Closeness],
    relations: Mapping[tuple[str, str], Relation],
    inputs: SeparateInputs,
) -> InputError:
    """InputError `separate.no_room` with one finding for every pair that is still too close, the worst first."""
    worst_first = sorted(left, key=lambda closeness: -_size(closeness))
    findings = tuple(_finding(tissues, closeness, relations[closeness.a, closeness.b]) for closeness in worst_first)
    return InputError(
        "separate.no_room",
        f"a gap of {inputs.min_gap_mm:g} mm could not be opened everywhere: {findings[0].message}; allow a larger "
        "`max_shift_mm`, let more surfaces move, or take finer surfaces: what was thinned out one by one has lost the room "
        "between its folds",
        findings=findings,
        pairs=len(left),
        min_gap_mm=inputs.min_gap_mm,
        max_shift_mm=inputs.max_shift_mm,
    )


def _size(closeness: Closeness) -> int:
    return sum(len(contact.faces) for contact in closeness.contacts) + sum(len(wrong) for wrong in closeness.wrong)


def _finding(tissues: Mapping[str, Tissue], closeness: Closeness, relation: Relation) -> Finding:
    a, b = closeness.a, closeness.b
    places, lengths = [], []
    for name, contact, wrong in zip((a, b), closeness.contacts, closeness.wrong, strict=True):
        mesh = tissues[name].original
        lengths.append(longest_edges(mesh.vertices, mesh.faces[contact.faces]))
        closest = contact.faces[np.argsort(contact.distance_mm, kind="stable")][: MAX_PLACES // 2]
        places += [*face_places(name, mesh, closest), *vertex_places(name, mesh, wrong[: MAX_PLACES // 2 - len(closest)])]
    faces = sum(len(contact.faces) for contact in closeness.contacts)
    stuck = [name for name in (a, b) if not tissues[name].movable]
    why = f"{' and '.join(stuck)} fixed" if stuck else "all room around them used up"
    edges = f", with edges up to {np.concatenate(lengths).max():.3g} mm long" if faces else ""
    return Finding(
        code="separate.no_room",
        severity=Severity.ERROR,
        message=f"{a}, {WORDS[relation]} {b}, stays too close at {faces} faces{edges} ({why})",
        count=_size(closeness),
        places=tuple(places[:MAX_PLACES]),
    )
