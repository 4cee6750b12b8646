"""Two meshes of a set against each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from core.geometry.containment import is_inside
from core.geometry.distance import Gap, closest_points_in, smallest_gap_between
from core.geometry.exact_intersection import Pairs
from core.geometry.intersection_case import classify_intersections
from core.schema.counted import counted
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.schema.report import PairReport, Relation
from core.validation.measure import significant
from core.validation.places import cluster_pairs, cluster_place, point_of
from core.validation.surface import Surface

ROUNDING_STEPS = 16  # float64 steps of the largest coordinate within which two places are one


@dataclass(frozen=True, eq=False)
class Pair:
    """What is known of two surfaces."""

    a: Surface
    b: Surface
    crossing: Pairs  # (K, 2) face of a, face of b: exact
    cases: tuple[int, int, int]  # of the crossings, thesis Fig. 19
    gap: Gap | None  # None if they cross
    touching: bool  # no crossing, but equal places
    relation: Relation
    shares_inside: tuple[float, float]  # of the pieces of a inside b, of the pieces of b inside a

    def report(self) -> PairReport:
        """The numbers."""
        case_1, case_2, case_3 = self.cases
        gap_mm = 0.0 if self.gap is None or self.touching else significant(self.gap.distance_mm)
        return PairReport(
            a=self.a.name,
            b=self.b.name,
            relation=self.relation,
            intersecting_pairs=len(self.crossing),
            case_1=case_1,
            case_2=case_2,
            case_3=case_3,
            min_gap_mm=gap_mm,
            min_gap_point_mm=point_of(self.gap.point_mm if self.gap else _middle(self.a, self.crossing[0, 0])),
        )


def compare(a: Surface, b: Surface, crossing: Pairs) -> Pair:
    """Measure two surfaces; crossing: (K, 2) all pairs face of a - face of b that intersect."""
    if len(crossing):
        cases = classify_intersections(a.mesh.triangles()[crossing[:, 0]], b.mesh.triangles()[crossing[:, 1]])
        counts = (int((cases == 1).sum()), int((cases == 2).sum()), int((cases == 3).sum()))
        return Pair(a, b, crossing, counts, None, False, "intersecting", (0.0, 0.0))
    gap = smallest_gap_between(a.tree, b.tree)
    largest = max(np.abs(a.mesh.vertices).max(), np.abs(b.mesh.vertices).max())
    touching = bool(gap.distance_mm <= ROUNDING_STEPS * np.spacing(largest))
    shares = (0.0, 0.0) if touching else (_share_inside(a, b), _share_inside(b, a))
    return Pair(a, b, crossing, (0, 0, 0), gap, touching, _relation(a, b, touching, shares), shares)


def _share_inside(inner: Surface, outer: Surface) -> float:
    """Share of the pieces of `inner` that lie inside `outer`; 0 if that is not closed. Neither may meet the other."""
    if not outer.closed or inner.component_count == 0:
        return 0.0
    return float(is_inside(outer.tree, inner.mesh.vertices[inner.component_vertex]).mean())


def _relation(a: Surface, b: Surface, touching: bool, shares: tuple[float, float]) -> Relation:
    if touching:
        return "undetermined"
    if shares[0] == 1.0:
        return "a_inside_b"
    if shares[1] == 1.0:
        return "b_inside_a"
    if max(shares) > 0.0 or not (a.closed and b.closed):
        return "undetermined"
    return "disjoint"


def _middle(surface: Surface, face: int) -> np.ndarray:
    """Centre of a face, (3,) mm."""
    middle: np.ndarray = surface.mesh.vertices[surface.mesh.faces[face]].mean(axis=0)
    return middle


def check_pair(pair: Pair, min_gap_mm: float) -> list[Finding]:
    """Report what keeps two meshes of a set apart too little; at most one finding."""
    a, b = pair.a.name, pair.b.name
    if len(pair.crossing):
        return [_crossing(pair)]
    if pair.touching:
        return [
            Finding(
                code="pair.touching",
                severity=Severity.ERROR,
                message=f"{a} and {b} touch: they do not cross, but have places in common",
                count=1,
                places=_closest(pair),
            )
        ]
    if pair.gap is not None and pair.gap.distance_mm < min_gap_mm:
        return [_too_close(pair, pair.gap, min_gap_mm)]
    if max(pair.shares_inside) > 0.0 and pair.relation == "undetermined":
        inner, outer, share = (a, b, pair.shares_inside[0]) if pair.shares_inside[0] > 0 else (b, a, pair.shares_inside[1])
        message = f"{inner} lies partly inside and partly outside {outer}: {share:.0%} of its pieces are inside"
        return [Finding(code="pair.partly_inside", severity=Severity.WARNING, message=message, count=1)]
    return []


def _crossing(pair: Pair) -> Finding:
    """One place on either mesh per cluster of crossing faces, largest cluster first."""
    faces_of_a, corners_of_a = len(pair.a.mesh.faces), len(pair.a.mesh.vertices)
    joined = np.concatenate((pair.a.mesh.faces, pair.b.mesh.faces + corners_of_a))
    clusters = cluster_pairs(joined, pair.crossing + np.array([0, faces_of_a]))
    places: list[Place] = []
    for faces in clusters[: MAX_PLACES // 2]:
        places.append(cluster_place(pair.a.name, pair.a.mesh, faces[faces < faces_of_a]))
        places.append(cluster_place(pair.b.name, pair.b.mesh, faces[faces >= faces_of_a] - faces_of_a))
    case_1, case_2, case_3 = pair.cases
    message = (
        f"{pair.a.name} and {pair.b.name} intersect: {len(pair.crossing)} pairs of faces in {counted(len(clusters), 'place')} "
        f"(case 1: {case_1}, case 2: {case_2}, case 3: {case_3})"
    )
    return Finding(
        code="pair.intersecting", severity=Severity.ERROR, message=message, count=len(pair.crossing), places=tuple(places)
    )


def _closest(pair: Pair) -> tuple[Place, ...]:
    """The place of the smallest gap, on either mesh."""
    if pair.gap is None:
        return ()
    point = point_of(pair.gap.point_mm)
    return (
        Place(mesh=pair.a.name, point_mm=point, faces=(pair.gap.face_a,)),
        Place(mesh=pair.b.name, point_mm=point, faces=(pair.gap.face_b,)),
    )


def _too_close(pair: Pair, gap: Gap, min_gap_mm: float) -> Finding:
    """The closest place first, then the vertices of a that are too close to b, closest first."""
    distance, _point, _face = closest_points_in(pair.b.tree, pair.a.mesh.vertices)
    near = np.flatnonzero(distance < min_gap_mm)
    near = near[np.argsort(distance[near], kind="stable")]
    places = _closest(pair) + tuple(
        Place(mesh=pair.a.name, point_mm=point_of(pair.a.mesh.vertices[vertex]), vertices=(int(vertex),))
        for vertex in near[: MAX_PLACES - 2]
    )
    message = (
        f"{pair.a.name} and {pair.b.name} come as close as {gap.distance_mm:.4g} mm; at least {min_gap_mm:g} mm is asked. "
        f"{len(near)} vertices of {pair.a.name} are too close"
    )
    return Finding(code="pair.gap_too_small", severity=Severity.ERROR, message=message, count=max(1, len(near)), places=places)
