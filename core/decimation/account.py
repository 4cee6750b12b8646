"""What decimation did, in numbers and findings."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.decimation.decimated import Decimated
from core.decimation.plan import Plan
from core.decimation.thinned import Thinned
from core.geometry.quality import quality
from core.geometry.volume import signed_volumes
from core.mesh import Mesh
from core.schema.decimate import DecimateInputs
from core.schema.finding import Finding, Place, Severity
from core.validation.places import point_of

WORDS = {
    "fixed": "both ends are fixed",
    "region": "a region keeps its faces",
    "topology": "the topology would change or a vertex get too many faces",
    "turned": "a face would turn over",
    "sliver": "a sliver would appear",
    "crowded": "faces would come too near each other",
    "deviation": "the surface would deviate too far",
}


def describe(result: Decimated, made: Thinned, plan: Plan, inputs: DecimateInputs) -> dict[str, Any]:
    """Plain facts for the report."""
    before, after = _volume(result.original), _volume(result.mesh)
    far = result.deviation.farthest()
    return {
        "change": "decimated",
        "method": "literal" if inputs.literal else inputs.method,
        "faces_before": len(result.original.faces),
        "faces_after": len(result.mesh.faces),
        "goal_faces": plan.goal,
        "max_deviation_mm": round(result.max_deviation_mm, 6),
        "rms_deviation_mm": round(result.deviation.rms_mm, 6),
        "farthest_at_mm": point_of(far),
        "mean_quality_before": round(float(quality(result.original.vertices, result.original.faces).mean()), 4),
        "mean_quality_after": round(float(quality(result.mesh.vertices, result.mesh.faces).mean()), 4),
        "volume_change_percent": round(100.0 * (after - before) / before, 6) if before else None,
        "collapses": made.attempts["done"],
        "refused": {reason: count for reason, count in made.attempts.items() if reason != "done" and count},
    }


def find_findings(name: str, result: Decimated, made: Thinned, plan: Plan, inputs: DecimateInputs) -> tuple[Finding, ...]:
    """What the user should know."""
    found: list[Finding] = []
    left, before = len(result.mesh.faces), len(result.original.faces)
    if inputs.max_deviation_mm is None and plan.goal >= before and not inputs.regions:
        found.append(
            Finding(
                code="decimate.nothing_to_do",
                severity=Severity.INFO,
                message=f"{name} has {before:,} faces, not more than the {plan.goal:,} asked for; it stayed as it was",
                count=1,
            )
        )
    elif inputs.max_deviation_mm is None and left > plan.goal:
        refused = {reason: count for reason, count in made.attempts.items() if reason in WORDS and count}
        reasons = ", ".join(
            f"{WORDS[reason]} ({count:,})" for reason, count in sorted(refused.items(), key=lambda row: -row[1])[:3]
        )
        found.append(
            Finding(
                code="decimate.target_not_reached",
                severity=Severity.WARNING,
                message=f"{name} has {left:,} faces, {plan.goal:,} were asked for; collapses were refused because {reasons}",
                count=left - plan.goal,
                places=(Place(mesh=name, point_mm=point_of(result.mesh.vertices.mean(axis=0))),),
            )
        )
    return tuple(found)


def _volume(mesh: Mesh) -> float:
    return float(signed_volumes(mesh.vertices, mesh.faces, np.zeros(len(mesh.faces), dtype=np.int64))[0])
