"""Rounds of moves until every two tissues are apart: each of them goes its share of the way, those that must not stay."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from core.run import RunContext
from core.separation.contacts import COINCIDENT_MM, Contacts, find_contacts
from core.separation.demand import Demand, find_demand
from core.separation.relations import Relation
from core.separation.sides import are_vertices_inside
from core.separation.tissue import Tissue

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Relations = Mapping[tuple[str, str], Relation]

GOAL = 1.1  # of the gap: what a move aims at ...
LIMIT = 1.01  # ... and what is enough
STEP_SHARE = 0.2  # of the mean edge at a vertex, its longest move in one round, unless the gap is longer
MOST_ROUNDS = 300
PATIENCE = 10  # rounds without progress after which those with priority help, and after as many more nothing will
WORTH = 0.02  # relative; less is no progress


@dataclass(frozen=True, eq=False, slots=True)
class Closeness:
    """Two tissues that are not apart: contacts of a with b and of b with a, and vertices of either on the wrong side."""

    a: str
    b: str
    contacts: tuple[Contacts, Contacts]
    wrong: tuple[Ints, Ints]

    @property
    def is_open(self) -> bool:
        """Nothing left to do."""
        return all(len(contact.faces) == 0 for contact in self.contacts) and all(len(wrong) == 0 for wrong in self.wrong)


@dataclass(slots=True)
class _Course:
    """How it goes: the least that was left to do, for how many rounds it has not become less, and who helps."""

    least: float = np.inf
    idle: int = 0
    everybody: bool = False
    wrong: dict[tuple[str, str], Ints] = field(default_factory=dict)


def open_gaps(
    tissues: Mapping[str, Tissue], relations: Relations, gap_mm: float, longest_mm: float, run: RunContext
) -> list[Closeness]:
    """Move tissues, in place, until all are apart or nothing helps; returns the pairs that are not.

    Keeps: every surface free of self-intersection in every step, fixed tissues where they are, faces unturned.
    """
    course = _Course(wrong=find_wrong(tissues, relations))
    first, done = 0.0, 0.0
    for count in range(MOST_ROUNDS):
        demands, left = _look(tissues, relations, gap_mm, course)
        if not left:
            # a step is no continuous motion: a small piece could have jumped through a wall, with nothing near to tell
            course.wrong = find_wrong(tissues, relations)
            if not any(len(wrong) for wrong in course.wrong.values()):
                return []
        rest = sum(float(np.linalg.norm(demand.ways, axis=1).sum()) for demand in demands.values())
        first = first or rest
        done = max(done, 1.0 - rest / first if first else 0.0)
        run.advance(done, f"round {count + 1}: {len(left)} pairs of surfaces, {_faces(left)} faces not apart")
        course.idle = 0 if rest < course.least * (1.0 - WORTH) else course.idle + 1
        course.least = min(course.least, rest)
        if course.idle >= PATIENCE:
            if course.everybody:
                return left
            course.everybody, course.idle = True, 0
        moved = 0
        for name, tissue in tissues.items():
            if tissue.movable:
                moved += tissue.move(_wish(tissue, tissues, name, demands, course.everybody, gap_mm), longest_mm)
        if moved == 0:
            if course.everybody:
                return left
            course.everybody, course.idle = True, 0
    return left


def find_wrong(tissues: Mapping[str, Tissue], relations: Relations) -> dict[tuple[str, str], Ints]:
    """Vertices of a on the wrong side of b, for every ordered pair."""
    found = {}
    for a, b in combinations(tissues, 2):
        meeting = find_contacts(tissues[a].tree, tissues[b].tree, COINCIDENT_MM)
        for (name, partner), contacts in zip(((a, b), (b, a)), meeting, strict=True):
            vertices, faces = tissues[name].vertices, tissues[name].original.faces
            within = are_vertices_inside(vertices, faces, tissues[partner].tree, contacts.faces)
            found[name, partner] = np.flatnonzero(within != (relations[name, partner] == "inside"))
    return found


def _look(
    tissues: Mapping[str, Tissue], relations: Relations, gap_mm: float, course: _Course
) -> tuple[dict[tuple[str, str], Demand], list[Closeness]]:
    """What every tissue would have to do for every other one, and the pairs that are not apart."""
    demands: dict[tuple[str, str], Demand] = {}
    left = []
    for a, b in combinations(tissues, 2):
        pair = tissues[a], tissues[b]
        enough = LIMIT if pair[0].movable or pair[1].movable else 1.0  # nobody there to do more than is asked
        contacts = find_contacts(pair[0].tree, pair[1].tree, enough * gap_mm)
        for (one, other), (name, partner), touching in zip((pair, pair[::-1]), ((a, b), (b, a)), contacts, strict=True):
            before = course.wrong[name, partner]
            demands[name, partner] = find_demand(one, other, relations[name, partner], touching, before, GOAL * gap_mm)
            course.wrong[name, partner] = demands[name, partner].wrong
        closeness = Closeness(a, b, contacts, (course.wrong[a, b], course.wrong[b, a]))
        if not closeness.is_open:
            left.append(closeness)
    return demands, left


def _wish(
    tissue: Tissue,
    tissues: Mapping[str, Tissue],
    name: str,
    demands: Mapping[tuple[str, str], Demand],
    everybody: bool,
    gap_mm: float,
) -> Floats:
    """Where the tissue's vertices go in this round, (V, 3) mm: for each other one its share, without adding up what is alike."""
    wish = np.zeros_like(tissue.vertices)
    for partner, other in tissues.items():
        if partner == name:
            continue
        demand = demands[name, partner]
        share = _share(tissue, other, everybody)
        if share == 0.0 or len(demand.vertices) == 0:
            continue
        wish[demand.vertices] = _joined(wish[demand.vertices], share * demand.ways)
    longest = np.maximum(STEP_SHARE * tissue.edge_mm, gap_mm)
    length = np.linalg.norm(wish, axis=1)
    cut: Floats = wish * np.minimum(longest / np.maximum(length, 1e-300), 1.0)[:, None]
    return cut


def _share(tissue: Tissue, other: Tissue, everybody: bool) -> float:
    """Of the way between two tissues, what this one goes."""
    if not other.movable:
        return 1.0
    if everybody or tissue.priority == other.priority:
        return 0.5
    return 1.0 if tissue.priority < other.priority else 0.0


def _joined(first: Floats, second: Floats) -> Floats:
    """Moves (K, 3) that do what both ask: along the first the longer of the two, across it the second."""
    length = np.linalg.norm(first, axis=1)
    unit = first / np.maximum(length, 1e-300)[:, None]
    along = np.einsum("ij,ij->i", second, unit)
    agreeing = (length > 0.0) & (along > 0.0)
    common = np.where(agreeing, np.minimum(along, length), 0.0)
    joined: Floats = first + second - common[:, None] * unit
    return joined


def _faces(left: list[Closeness]) -> int:
    return sum(len(contact.faces) for closeness in left for contact in closeness.contacts)
