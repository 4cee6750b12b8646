"""Smoothing of one surface or of several together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, InternalError
from core.geometry.clearance import Clearance
from core.geometry.distance import closest_points_in, smallest_gap_between
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.finding import Finding
from core.schema.smooth import SmoothInputs
from core.smoothing.account import describe, find_findings
from core.smoothing.company import Company
from core.smoothing.guarded_step import OWN_CLEARANCE_MM, GuardedSurface
from core.smoothing.journey import Journey
from core.smoothing.movable import is_free, is_in_regions, require_regions
from core.smoothing.progress import Progress
from core.validation.requirements import require_sound_surface

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, slots=True)
class Smoothed:
    """One smoothed surface, and how it became so.

    mesh: exact in float32. original: what was smoothed, rounded to float32; vertices have the same numbers in both.
    progress: before the first iteration, then after each one that was made, as far as it was delivered or tried.
    delivered: the iteration that `mesh` is; best: the one with the highest lowest quality. shift_mm: (V,) way of each vertex.
    deviation_mm, original_deviation_mm: (V,) from the vertices of the result to the original surface, and back.
    """

    mesh: Mesh
    original: Mesh
    progress: tuple[Progress, ...]
    best: int
    delivered: int
    shift_mm: Floats
    deviation_mm: Floats
    original_deviation_mm: Floats
    changes: tuple[dict[str, Any], ...]
    findings: tuple[Finding, ...]


def smooth(surfaces: Mapping[str, Mesh], inputs: SmoothInputs, run: RunContext = SILENT) -> dict[str, Smoothed]:
    """Smooth surfaces by name; several of them stay `inputs.min_gap_mm` apart.

    Needs:    manifold, oriented surfaces, open or closed, free of self-intersection and `min_gap_mm` apart.
    Promises: exactly free of self-intersection; same vertices, and same faces unless edges are flipped; vertices outside the
              regions, and on rims, keep their float32 coordinates; none goes farther than `max_shift_mm`; no face turns over in
              a step; with `stop` `quality` the lowest quality does not fall; what lay in what still does; coordinates exact in
              float32; same input, same bytes.
    Raises:   InputError `surface.*`, `surfaces.too_close`, `region.outside_mesh`; InternalError `smooth.not_proven`.
    Source:   thesis 3.4; Vollmer et al. 1999; Taubin 1995; method in docs/algorithms/smoothing.md.
    """
    stage = run.stage("smooth: look at the surfaces", 0.0, 0.1)
    originals = {name: mesh.rounded_to_float32() for name, mesh in surfaces.items()}
    require_regions(originals, inputs.regions)
    for count, (name, mesh) in enumerate(originals.items()):
        require_sound_surface(mesh, name)
        stage.advance((count + 1) / len(originals))
    company = Company(originals)
    trees = {name: company.tree(name) for name in originals}
    _require_apart(trees, inputs.min_gap_mm)

    clearance = Clearance(inputs.min_gap_mm, min(OWN_CLEARANCE_MM, inputs.min_gap_mm), ())
    journeys = {name: _set_out(name, mesh, company, inputs, clearance) for name, mesh in originals.items()}
    stage = run.stage("smooth: iterations", 0.1, 0.9)
    for count in range(inputs.iterations):
        going = [name for name, journey in journeys.items() if not journey.at_rest]
        if not going:
            break
        for name in going:
            journeys[name].go(count + 1)
        lowest = min(journey.progress[-1].lowest_quality for journey in journeys.values())
        stage.advance((count + 1) / inputs.iterations, f"iteration {count + 1}: lowest quality {lowest:.4g}")
    for journey in journeys.values():
        journey.arrive()

    run.stage("smooth: proof", 0.9, 1.0)
    meshes = {name: Mesh.of(journey.state.vertices, journey.state.net.faces) for name, journey in journeys.items()}
    _prove(meshes, originals, journeys, inputs)
    return {name: _smoothed(name, mesh, originals[name], trees[name], journeys[name], inputs) for name, mesh in meshes.items()}


def _set_out(name: str, mesh: Mesh, company: Company, inputs: SmoothInputs, clearance: Clearance) -> Journey:
    within = is_in_regions(mesh, inputs.regions)
    chosen = np.flatnonzero(within & is_free(mesh))
    return Journey.of(name, mesh, company, GuardedSurface.of(mesh, chosen, clearance), within, inputs)


def _require_apart(trees: Mapping[str, FaceTree], min_gap_mm: float) -> None:
    for (a, tree_a), (b, tree_b) in combinations(trees.items(), 2):
        gap = smallest_gap_between(tree_a, tree_b)
        if gap.distance_mm < min_gap_mm:
            x, y, z = gap.point_mm
            raise InputError(
                "surfaces.too_close",
                f"{a} and {b} are {gap.distance_mm:.4g} mm apart at ({x:.6g}, {y:.6g}, {z:.6g}) mm, so smoothing cannot keep "
                f"them {min_gap_mm:g} mm apart; ask for a smaller min_gap_mm, or move them apart first",
                a=a,
                b=b,
                gap_mm=gap.distance_mm,
                min_gap_mm=min_gap_mm,
            )


def _prove(
    meshes: Mapping[str, Mesh], originals: Mapping[str, Mesh], journeys: Mapping[str, Journey], inputs: SmoothInputs
) -> None:
    """What was promised, on what is handed out. Raises: InternalError `smooth.not_proven`."""
    broken = []
    for name, mesh in meshes.items():
        pairs = find_intersecting_faces(mesh.vertices, mesh.faces)
        if len(pairs):
            broken.append(f"{name} runs through itself at {len(pairs)} pairs of faces")
        stay = np.ones(len(mesh.vertices), dtype=np.bool_)
        stay[journeys[name].state.chosen] = False
        if (mesh.vertices[stay] != originals[name].vertices[stay]).any():
            broken.append(f"{name} moved where it may not")
        farthest = float(np.linalg.norm(mesh.vertices - originals[name].vertices, axis=1).max())
        if inputs.max_shift_mm is not None and farthest > inputs.max_shift_mm:
            broken.append(f"a vertex of {name} is {farthest:.6g} mm from where it was")
    trees = {name: FaceTree.of(mesh.vertices, mesh.faces) for name, mesh in meshes.items()}
    for a, b in combinations(trees, 2):
        gap = smallest_gap_between(trees[a], trees[b]).distance_mm
        if gap < inputs.min_gap_mm:
            broken.append(f"{a} and {b} are {gap:.6g} mm apart")
    if broken:
        raise InternalError("smooth.not_proven", "the smoothed surfaces are not handed out: " + "; ".join(broken))


def _smoothed(name: str, mesh: Mesh, original: Mesh, tree: FaceTree, journey: Journey, inputs: SmoothInputs) -> Smoothed:
    deviation = closest_points_in(tree, mesh.vertices)[0]
    original_deviation = closest_points_in(FaceTree.of(mesh.vertices, mesh.faces), original.vertices)[0]
    return Smoothed(
        mesh=mesh,
        original=original,
        progress=tuple(journey.progress),
        best=journey.best,
        delivered=journey.delivered,
        shift_mm=np.linalg.norm(mesh.vertices - original.vertices, axis=1),
        deviation_mm=deviation,
        original_deviation_mm=original_deviation,
        changes=(describe(journey, mesh, original, deviation, original_deviation, inputs),),
        findings=find_findings(name, mesh, journey),
    )
