"""From the report of one subject to the numbers that can be compared between subjects."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

ONLY = "mesh"  # a single surface bears the name of its upload, so of another subject another
OF_MESH = ("faces", "components", "genus", "area_mm2", "volume_mm3", "self_intersecting_pairs", "minimum_dihedral_deg")
OF_THICKNESS = ("on_target_area", "limited_area", "missed_area", "min_mm")
OF_REGION = ("tetrahedra", "volume_mm3", "quality_minimum", "smallest_dihedral_deg")
OF_COMPARISON = ("area_change", "volume_change")
COLUMNS_AT_MOST = 200


def numbers_of(report: Mapping[str, Any]) -> dict[str, float]:
    """Column -> value, in the order of the report; what is absent or not finite is left out.

    The report is read as it stands, not as this version would write it: workers of two versions may share a cohort."""
    found = ((name, value) for name, value in _columns(report) if _is_number(value))
    return {name: value for (name, value), _ in zip(found, range(COLUMNS_AT_MOST), strict=False)}


def _columns(report: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    meshes = _objects(report.get("meshes"))
    alone = len(meshes) == 1
    for name, mesh in meshes.items():
        shown = ONLY if alone else name
        yield from ((f"{shown}.{key}", mesh.get(key)) for key in OF_MESH)
        yield f"{shown}.quality_minimum", _objects(mesh).get("quality", {}).get("minimum")
    for pair in report.get("pairs") or ():
        between = f"{pair.get('a')}-{pair.get('b')}"
        yield f"{between}.intersecting_pairs", pair.get("intersecting_pairs")
        yield f"{between}.min_gap_mm", pair.get("min_gap_mm")
    for layer, thickness in _objects(report.get("thickness")).items():
        yield from ((f"{layer}.{key}", thickness.get(key)) for key in OF_THICKNESS)
    for name, comparison in _objects(report.get("comparisons")).items():
        shown = ONLY if alone else name
        yield f"{shown}.deviation_mm", _objects(comparison).get("deviation", {}).get("maximum_mm")
        yield from ((f"{shown}.{key}", comparison.get(key)) for key in OF_COMPARISON)
    for tissue, region in _objects(report.get("regions")).items():
        yield from ((f"{tissue}.{key}", region.get(key)) for key in OF_REGION)
    for step in report.get("steps") or ():
        yield from ((f"{step.get('name')}: {key}", value) for key, value in (step.get("numbers") or {}).items())
    severities = [finding.get("severity") for finding in report.get("findings") or ()]
    yield "errors", severities.count("error")
    yield "warnings", severities.count("warning")


def _objects(value: Any) -> dict[str, Any]:
    """The members that are objects themselves."""
    return {key: item for key, item in value.items() if isinstance(item, dict)} if isinstance(value, dict) else {}


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
