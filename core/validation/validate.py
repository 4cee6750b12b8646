"""All checks on a set of meshes, and the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from core.geometry.exact_intersection import Pairs, find_intersecting_faces
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.finding import Finding, has_errors
from core.schema.report import MeshReport, PairReport, Verdict
from core.validation.closed import check_closed
from core.validation.components import check_components
from core.validation.faces import check_degenerate_faces, check_duplicate_faces
from core.validation.manifold import check_edge_manifold, check_vertex_manifold
from core.validation.measure import measure_surface
from core.validation.nesting import nest
from core.validation.orientation import check_orientation, check_outward
from core.validation.pair import check_pair, compare
from core.validation.self_intersection import check_self_intersection
from core.validation.shape import check_dihedral, check_quality
from core.validation.surface import Surface
from core.validation.vertices import check_coincident_vertices, check_unused_vertices

CHECKS = (
    check_closed,
    check_edge_manifold,
    check_vertex_manifold,
    check_orientation,
    check_outward,
    check_degenerate_faces,
    check_duplicate_faces,
    check_coincident_vertices,
    check_self_intersection,
    check_components,
    check_quality,
    check_dihedral,
    check_unused_vertices,
)


@dataclass(frozen=True)
class Validation:
    """What was found; the parts of a report that describe meshes."""

    meshes: dict[str, MeshReport]
    pairs: tuple[PairReport, ...]
    nesting: dict[str, str | None]
    findings: tuple[Finding, ...]
    verdict: Verdict


def validate(meshes: Mapping[str, Mesh], *, min_gap_mm: float = 0.0, run: RunContext = SILENT) -> Validation:
    """Check every mesh, and every pair of the set.

    Needs:    one or more meshes; nothing is asked of their shape.
    Promises: intersections are exact, gaps are minima in float64; `simulation_ready` exactly if no finding is an error;
              same input, same result.
    Raises:   nothing: an unfit mesh is a result.
    Source:   thesis 2.4.1, 2.6.1 and 2.6.2 (Fig. 18 and 19)."""
    surfaces, crossings = _intersect(meshes, run.stage("validate: intersections", 0.0, 0.4))
    findings: list[Finding] = []
    reports: dict[str, MeshReport] = {}
    step = run.stage("validate: meshes", 0.4, 0.75)
    for number, surface in enumerate(surfaces):
        findings += [finding for check in CHECKS for finding in check(surface)]
        reports[surface.name] = measure_surface(surface)
        step.advance((number + 1) / len(surfaces), f"{surface.name}: {len(surface.mesh.faces)} faces checked")
    pairs: list[PairReport] = []
    step = run.stage("validate: pairs", 0.75, 1.0)
    for number, (i, j) in enumerate(combinations(range(len(surfaces)), 2)):
        pair = compare(surfaces[i], surfaces[j], crossings[i, j])
        findings += check_pair(pair, min_gap_mm)
        pairs.append(pair.report())
        done = (number + 1) / (len(surfaces) * (len(surfaces) - 1) // 2)
        step.advance(done, f"{pairs[-1].a} and {pairs[-1].b}: gap {pairs[-1].min_gap_mm:.4g} mm")
    verdict: Verdict = "not_ready" if has_errors(findings) else "simulation_ready"
    return Validation(reports, tuple(pairs), nest(list(meshes), pairs), tuple(findings), verdict)


def _intersect(meshes: Mapping[str, Mesh], run: RunContext) -> tuple[list[Surface], dict[tuple[int, int], Pairs]]:
    """Surfaces that know their own intersections, and the pairs between each two of them, from one exact call."""
    first_vertex = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes.values()])
    first_face = np.cumsum([0] + [len(mesh.faces) for mesh in meshes.values()])
    pairs = find_intersecting_faces(
        np.concatenate([mesh.vertices for mesh in meshes.values()]),
        np.concatenate([mesh.faces + np.int32(start) for mesh, start in zip(meshes.values(), first_vertex, strict=False)]),
    )
    run.advance(1.0, f"{first_face[-1]} faces, {len(pairs)} intersecting pairs")
    of_pair = np.searchsorted(first_face, pairs, side="right") - 1
    count = len(meshes)
    groups = {(i, j): pairs[(of_pair == [i, j]).all(axis=1)] - first_face[[i, j]] for i in range(count) for j in range(i, count)}
    surfaces = [Surface(name, mesh, groups[i, i]) for i, (name, mesh) in enumerate(meshes.items())]
    return surfaces, groups
