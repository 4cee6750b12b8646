"""Tissues that cross or touch, moved apart until a thin gap lies between every two of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, InternalError
from core.geometry.clearance import Clearance
from core.geometry.distance import smallest_gap_between
from core.geometry.exact_intersection import find_intersecting_faces
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.separate import SeparateInputs
from core.separation.finer import refine_stuck
from core.separation.no_room import no_room
from core.separation.opening import Relations, find_wrong, open_gaps
from core.separation.relations import Relation, find_relations
from core.separation.tissue import Tissue
from core.smoothing.guarded_step import OWN_CLEARANCE_MM
from core.validation.requirements import require_outward_surface

Floats = NDArray[np.float64]

MOST_REFINEMENTS = 3  # times that faces are halved where tissues stay too close
EASING_ROUNDS = 5
TOGETHER_ROUNDS = 2  # of them, in which all vertices of a surface try at once
EASED = 1.001  # of the gap: what vertices on their way home keep
SLACK = 1e-9  # of the gap: the same minimum found on another path through the trees


@dataclass(frozen=True, eq=False, slots=True)
class Separated:
    """One tissue and what became of it.

    mesh: exact in float32. original: as it came, rounded to float32, with the same faces: where they were too large to bend they
    are halved in both. shift_mm: (V,) way of each vertex. faces_added: by halving.
    """

    mesh: Mesh
    original: Mesh
    shift_mm: Floats
    faces_added: int


@dataclass(frozen=True, eq=False, slots=True)
class Separation:
    """All tissues by name, what each is to each other one, and the smallest gap of those that are near, in mm."""

    tissues: Mapping[str, Separated]
    relations: Mapping[tuple[str, str], Relation]
    gaps_mm: Mapping[tuple[str, str], float]


def separate(surfaces: Mapping[str, Mesh], inputs: SeparateInputs, run: RunContext = SILENT) -> Separation:
    """Open `inputs.min_gap_mm` between every two surfaces.

    Needs:    closed, manifold surfaces free of self-intersection; between them they may cross and touch.
    Promises: no two of them intersect (exact) and every two are the gap apart, on coordinates exact in float32; each lies where
              `relations` says; none intersects itself; vertices keep their numbers, and faces, too, but where they are halved
              because they are too large to bend; fixed ones keep every bit; no vertex goes farther than
              `inputs.max_shift_mm`; same input, same bytes.
    Raises:   InputError `surface.*`, `separate.*`; InternalError `separate.not_proven`.
    Source:   thesis Eq. (4.1), 4.1; method in docs/algorithms/separation.md.
    """
    look = run.stage("separate: look at the surfaces", 0.0, 0.1)
    originals = {name: mesh.rounded_to_float32() for name, mesh in surfaces.items()}
    _require_known(inputs, originals)
    for count, (name, mesh) in enumerate(originals.items()):
        require_outward_surface(mesh, name)
        look.advance((count + 1) / len(originals))
    relations = find_relations(originals, inputs.inside)
    gap_mm = inputs.min_gap_mm
    tissues = _open(originals, relations, inputs, run.stage("separate: open gaps", 0.1, 0.7))
    _ease(tissues, gap_mm, run.stage("separate: take back", 0.7, 0.9))
    prove = run.stage("separate: proof", 0.9, 1.0)
    gaps = _prove(tissues, relations, gap_mm)
    prove.advance(1.0, f"smallest gap {min(gaps.values()):.4g} mm" if gaps else "")
    made = {name: _separated(tissue, len(surfaces[name].faces)) for name, tissue in tissues.items()}
    return Separation(made, relations, gaps)


def _open(originals: Mapping[str, Mesh], relations: Relations, inputs: SeparateInputs, run: RunContext) -> dict[str, Tissue]:
    """All tissues apart; with finer faces where that is not possible with theirs. Raises: InputError `separate.no_room`."""
    gap_mm, surfaces = inputs.min_gap_mm, dict(originals)
    came = {name: len(mesh.faces) for name, mesh in originals.items()}
    for refinement in range(MOST_REFINEMENTS + 1):
        tissues = {
            name: Tissue.of(name, mesh, inputs.priority.get(name, 0), gap_mm, movable=name not in inputs.fixed)
            for name, mesh in surfaces.items()
        }
        left = open_gaps(tissues, relations, gap_mm, inputs.max_shift_mm, run)
        if not left:
            break
        finer = refine_stuck(tissues, left, gap_mm, came) if refinement < MOST_REFINEMENTS else {}
        if not finer:
            raise no_room(tissues, originals, left, relations, inputs)
        surfaces |= finer
        run.log(
            "finer where they stay too close: " + ", ".join(f"{name} {len(mesh.faces)} faces" for name, mesh in finer.items())
        )
    return tissues


def _require_known(inputs: SeparateInputs, surfaces: Mapping[str, Mesh]) -> None:
    holders = [holder for holder in inputs.inside.values() if holder is not None]
    unknown = sorted({*inputs.fixed, *inputs.priority, *inputs.inside, *holders} - set(surfaces))
    if unknown:
        raise InputError(
            "separate.unknown_tissue",
            f"fixed, priority or inside name {', '.join(unknown)}; the surfaces are {', '.join(surfaces)}",
        )


def _ease(tissues: Mapping[str, Tissue], gap_mm: float, run: RunContext) -> None:
    """What went farther than it had to goes back, one tissue after the other, as far as the gap holds."""
    clearance = Clearance(EASED * gap_mm, min(OWN_CLEARANCE_MM, gap_mm), ())
    for count in range(EASING_ROUNDS):
        moved = 0
        for name, tissue in tissues.items():
            others = tuple(other.tree for partner, other in tissues.items() if partner != name)
            moved += tissue.ease(others, clearance, one_by_one=count >= TOGETHER_ROUNDS)
        run.advance((count + 1) / EASING_ROUNDS, f"{moved} vertices moved back")


def _prove(tissues: Mapping[str, Tissue], relations: Relations, gap_mm: float) -> dict[tuple[str, str], float]:
    """What was promised, on what is handed out. Raises: InternalError `separate.not_proven`."""
    starts = np.cumsum([0, *(len(tissue.vertices) for tissue in tissues.values())])
    faces = np.concatenate(
        [tissue.original.faces + np.int32(start) for tissue, start in zip(tissues.values(), starts, strict=False)]
    )
    pairs = find_intersecting_faces(np.concatenate([tissue.vertices for tissue in tissues.values()]), faces)
    broken = [f"{len(pairs)} pairs of faces intersect"] if len(pairs) else []
    gaps = {(a, b): smallest_gap_between(tissues[a].tree, tissues[b].tree).distance_mm for a, b in combinations(tissues, 2)}
    broken += [f"{a} and {b} are {gap:.6g} mm apart" for (a, b), gap in gaps.items() if gap < gap_mm * (1.0 - SLACK)]
    astray = {pair: len(wrong) for pair, wrong in find_wrong(tissues, relations).items() if len(wrong)}
    broken += [f"{count} vertices of {a} lie on the wrong side of {b}" for (a, b), count in astray.items()]
    if broken:
        raise InternalError("separate.not_proven", "the separated surfaces are not handed out: " + "; ".join(broken))
    return gaps


def _separated(tissue: Tissue, came: int) -> Separated:
    mesh = tissue.original.with_vertices(tissue.vertices)
    shift_mm = np.linalg.norm(tissue.displacement(), axis=1)
    return Separated(mesh, tissue.original, shift_mm, len(mesh.faces) - came)
