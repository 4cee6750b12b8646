"""Fewer faces, the same surface."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from core.decimation.account import describe, find_findings
from core.decimation.curvature import mean_neighbour_angles_deg
from core.decimation.decimated import Decimated
from core.decimation.dense_samples import measure_densely
from core.decimation.literal import collapse_literally
from core.decimation.nearness import ANYWHERE, Nearness
from core.decimation.plan import Plan, make_plans
from core.decimation.room import NO_OBSTACLES, Obstacles
from core.decimation.thinned import Means, Thinned, thinned
from core.errors import InputError, InternalError
from core.geometry.deviation import measure_deviation
from core.geometry.distance import smallest_gap_between
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas
from core.mesh import Mesh
from core.run import SILENT, RunContext
from core.schema.decimate import DecimateInputs
from core.validation.requirements import require_closed_surface

Flags = NDArray[np.bool_]

OWN_CLEARANCE_MM = 1e-3  # between faces of one surface that share no corner, where new ones appear
ATTEMPTS = 12  # with more and more care where the proof found a fault
TIGHTER = 0.7  # a limit of deviation is lowered by this where it was not kept
LIMIT_SHARE = 0.95  # of max_deviation_mm is given to single collapses; between their samples it may be a little more


def decimate(surfaces: Mapping[str, Mesh], inputs: DecimateInputs, run: RunContext = SILENT) -> dict[str, Decimated]:
    """Decimate surfaces by name; several of them stay `inputs.min_gap_mm` apart.

    Needs:    closed manifolds, consistently oriented, free of self-intersection, several of them `min_gap_mm` apart.
    Promises: the same topology, no self-intersection (exact), the gap; with `max_deviation_mm` no sample further away than
              that, both ways. Coordinates are exact in float32. Same input, same bytes. `literal` promises nothing.
    Raises:   InputError `surface.*`, `surfaces.too_close`, `region.*`, `decimate.*`; InternalError `decimate.not_proven`.
    Source:   thesis Ch. 3; Garland & Heckbert 1997, doi:10.1145/258734.258849; method in docs/algorithms/decimation.md.
    """
    stage = run.stage("decimate: look at the surfaces", 0.0, 0.1)
    originals = {name: _compact(mesh.rounded_to_float32()) for name, mesh in surfaces.items()}
    if not inputs.literal:
        for done, (name, mesh) in enumerate(originals.items()):
            require_closed_surface(mesh, name)
            stage.advance((done + 1) / len(originals))
    plans = make_plans(originals, inputs)
    if not inputs.literal:
        _require_apart(originals, inputs.min_gap_mm)

    current = dict(originals)
    asked = inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"})
    results: dict[str, Decimated] = {}
    for row, (name, mesh) in enumerate(originals.items()):
        stage = run.stage(f"decimate: {name}", 0.1 + 0.9 * row / len(originals), 0.1 + 0.9 * (row + 1) / len(originals))
        others = [other for key, other in current.items() if key != name]
        make = partial(_decimate_literally if inputs.literal else _decimate_one, name, mesh, plans[name], others, inputs, stage)
        results[name] = stage.checkpoint("decimate", make, name, originals, current, asked)
        current[name] = results[name].mesh
    if not inputs.literal:
        _prove_apart(current, inputs.min_gap_mm)
    return results


def _decimate_literally(
    name: str, mesh: Mesh, plan: Plan, _others: list[Mesh], inputs: DecimateInputs, _run: RunContext
) -> Decimated:
    return _account(name, mesh, collapse_literally(mesh, plan.goal, inputs.smooth_weight), plan, inputs)


def _decimate_one(name: str, mesh: Mesh, plan: Plan, others: list[Mesh], inputs: DecimateInputs, run: RunContext) -> Decimated:
    """Thin, prove, and where the proof fails lock the place and thin again."""
    limit = inputs.max_deviation_mm or math.inf
    nearness = _nearness(mesh, inputs.max_deviation_mm)
    means = Means(inputs.method == "curvature", inputs.smooth_weight, OWN_CLEARANCE_MM, _obstacles(others, inputs.min_gap_mm))
    locked = np.zeros(len(mesh.vertices), dtype=np.bool_)
    for attempt in range(ATTEMPTS):
        made = thinned(mesh, plan, locked, nearness, means, run.stage(f"decimate: {name}", 0.0, 0.8))
        pairs = find_intersecting_faces(made.mesh.vertices, made.mesh.faces)
        if len(pairs):
            crossing = np.zeros(len(made.mesh.vertices), dtype=np.bool_)
            crossing[made.mesh.faces[pairs.ravel()].ravel()] = True
            # what crosses may have been let pass unasked once, not twice
            if means.thorough:
                locked |= _around(mesh, crossing[made.stand_in])
            means = replace(means, thorough=True)
            run.log(
                f"{name}: attempt {attempt + 1} left {len(pairs):,} crossing pairs of faces; thinned again, with more care there"
            )
            continue
        result = _account(name, mesh, made, plan, inputs)
        if result.max_deviation_mm <= limit:
            return result
        far = _around(mesh, _find_far(result, made, mesh, limit)[made.stand_in])
        nearness.limits_mm[far] *= TIGHTER
        run.log(
            f"{name}: attempt {attempt + 1} deviates by up to {result.max_deviation_mm:.4g} mm; thinned again, with tighter "
            f"limits at {int(far.sum()):,} vertices"
        )
    raise InternalError(
        "decimate.not_proven", f"{name}: {ATTEMPTS} attempts left faces that cross or deviate too far", attempts=ATTEMPTS
    )


def _nearness(mesh: Mesh, limit_mm: float | None) -> Nearness:
    if limit_mm is None:
        return ANYWHERE
    tree = FaceTree.of(mesh.vertices, mesh.faces)
    limits = np.full(len(mesh.vertices), LIMIT_SHARE * limit_mm)
    return ANYWHERE._replace(asked=True, limits_mm=limits, boxes=tree.boxes, corners=tree.corners, leaves=tree.leaves)


def _find_far(result: Decimated, made: Thinned, mesh: Mesh, limit: float) -> Flags:
    """Vertices (V',) of the result near samples that are further away than the limit."""
    far = np.zeros(len(made.mesh.vertices), dtype=np.bool_)
    tree = FaceTree.of(mesh.vertices, mesh.faces)
    worst = np.maximum(measure_densely(made.mesh, tree, _spacing(mesh)), result.deviation.back.per_face())
    far[made.mesh.faces[worst > limit].ravel()] = True
    far[made.stand_in[mesh.faces[result.deviation.forth.per_face() > limit].ravel()]] = True
    return far


def _around(mesh: Mesh, vertices: Flags) -> Flags:
    """The vertices (V,) and their neighbours."""
    grown = vertices.copy()
    grown[mesh.faces[vertices[mesh.faces].any(axis=1)].ravel()] = True
    return grown


def _account(name: str, mesh: Mesh, made: Thinned, plan: Plan, inputs: DecimateInputs) -> Decimated:
    """Measure what was made."""
    deviation = measure_deviation(mesh, made.mesh)
    dense = measure_densely(made.mesh, FaceTree.of(mesh.vertices, mesh.faces), _spacing(mesh))
    result = Decimated(
        mesh=made.mesh,
        original=mesh,
        deviation=deviation,
        max_deviation_mm=max(deviation.maximum_mm, float(dense.max())),
        curvature_before_deg=mean_neighbour_angles_deg(mesh),
        curvature_after_deg=mean_neighbour_angles_deg(made.mesh),
        changes=(),
        findings=(),
    )
    return replace(
        result, changes=(describe(result, made, plan, inputs),), findings=find_findings(name, result, made, plan, inputs)
    )


def _spacing(mesh: Mesh) -> float:
    """Side of an equilateral triangle of the mean area, mm."""
    return float(np.sqrt(face_areas(mesh.vertices, mesh.faces).mean() / 0.433))


def _compact(mesh: Mesh) -> Mesh:
    """The mesh without vertices that belong to no face."""
    used = np.zeros(len(mesh.vertices), dtype=np.bool_)
    used[mesh.faces.ravel()] = True
    if used.all():
        return mesh
    return Mesh.of(mesh.vertices[used], (np.cumsum(used) - 1)[mesh.faces])


def _obstacles(others: list[Mesh], gap_mm: float) -> Obstacles:
    """All other surfaces as one."""
    if not others:
        return NO_OBSTACLES
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in others])
    vertices = np.concatenate([mesh.vertices for mesh in others])
    faces = np.concatenate([mesh.faces + np.int32(start) for mesh, start in zip(others, first, strict=False)])
    tree = FaceTree.of(vertices, faces)
    return Obstacles(tree.boxes, tree.corners, tree.leaves, gap_mm**2)


def _require_apart(surfaces: Mapping[str, Mesh], min_gap_mm: float) -> None:
    for a, b, gap, (x, y, z) in _gaps(surfaces):
        if gap < min_gap_mm:
            raise InputError(
                "surfaces.too_close",
                f"{a} and {b} are {gap:.4g} mm apart at ({x:.6g}, {y:.6g}, {z:.6g}) mm, so decimation cannot keep them "
                f"{min_gap_mm:g} mm apart; ask for a smaller min_gap_mm, or move them apart first",
                a=a,
                b=b,
                gap_mm=gap,
                min_gap_mm=min_gap_mm,
            )


def _prove_apart(surfaces: Mapping[str, Mesh], min_gap_mm: float) -> None:
    """Raises: InternalError `decimate.not_proven`."""
    for a, b, gap, _point in _gaps(surfaces):
        if gap < min_gap_mm * (1.0 - 1e-9):
            raise InternalError("decimate.not_proven", f"{a} and {b} came to {gap:.6g} mm of each other", gap_mm=gap)


def _gaps(surfaces: Mapping[str, Mesh]) -> list[tuple[str, str, float, tuple[float, float, float]]]:
    trees = {name: FaceTree.of(mesh.vertices, mesh.faces) for name, mesh in surfaces.items()} if len(surfaces) > 1 else {}
    found = []
    for a, b in combinations(trees, 2):
        gap = smallest_gap_between(trees[a], trees[b])
        found.append((a, b, gap.distance_mm, gap.point_mm))
    return found
