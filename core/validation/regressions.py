"""Whether surfaces became worse than those they were made from."""

from __future__ import annotations

from core.schema.finding import Severity
from core.schema.report import MeshReport, PairReport
from core.validation.validate import Validation

GOOD = ("closed", "edge_manifold", "vertex_manifold", "consistently_oriented", "oriented_outward")
BAD = ("degenerate_faces", "duplicate_faces", "self_intersecting_pairs")
SHAPE = ("components", "euler_characteristic")
SLACK = 1e-9  # of a gap: the same minimum found on another path through the trees


def find_regressions(before: Validation, after: Validation, min_gap_mm: float) -> list[str]:
    """What is worse than before, in words; empty if nothing is. The pieces and their genus must be the same, too."""
    worse: list[str] = []
    for name, now in after.meshes.items():
        worse += [f"{name}: {words}" for words in _regressions(before.meshes[name], now)]
    former = {(pair.a, pair.b): pair for pair in before.pairs}
    for pair in after.pairs:
        worse += _pair_regressions(former.get((pair.a, pair.b)) or former[pair.b, pair.a], pair, min_gap_mm)
    if before.nesting != after.nesting:
        worse.append(f"the surfaces nest as {after.nesting}, not {before.nesting}")
    if before.verdict == "simulation_ready":
        worse += [finding.message for finding in after.findings if finding.severity is Severity.ERROR]
    return list(dict.fromkeys(worse))


def _regressions(before: MeshReport, after: MeshReport) -> list[str]:
    worse = [f"no longer {name.replace('_', ' ')}" for name in GOOD if getattr(before, name) and not getattr(after, name)]
    for name in BAD:
        was, now = getattr(before, name), getattr(after, name)
        worse += [f"{now} {name.replace('_', ' ')} where there were {was}"] if now > was else []
    for name in SHAPE:
        was, now = getattr(before, name), getattr(after, name)
        worse += [f"{name.replace('_', ' ')} {now}, not {was}"] if now != was else []
    return worse


def _pair_regressions(before: PairReport, after: PairReport, min_gap_mm: float) -> list[str]:
    words = f"{after.a} and {after.b}"
    if after.intersecting_pairs > before.intersecting_pairs:
        return [f"{words}: {after.intersecting_pairs} intersecting pairs of faces where there were {before.intersecting_pairs}"]
    if before.min_gap_mm is None or after.min_gap_mm is None:
        return []
    wanted = min(before.min_gap_mm, min_gap_mm)
    if after.min_gap_mm < wanted * (1.0 - SLACK):
        return [f"{words}: {after.min_gap_mm:.4g} mm apart, less than {wanted:.4g} mm"]
    return []
