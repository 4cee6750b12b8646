"""The process `heal`: defective surfaces made fit with the smallest change, proven on the files that are delivered."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import IntegumentError
from core.healing.heal import Healed, heal
from core.mesh import Mesh
from core.processes.loaded_surfaces import load_surfaces
from core.processes.outcome import Outcome
from core.processes.proof import validate_once
from core.processes.surface_package import PROOF, SurfaceJob, deliver_surfaces
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.figures.change_places import draw_change_places
from core.run import RunContext
from core.schema.counted import counted
from core.schema.finding import Finding, Severity
from core.schema.heal import HealInputs
from core.schema.report import Report
from core.validation.regressions import find_regressions
from core.validation.validate import Validation

METHODS = (
    "The surface was mended by a fixed sequence of local steps, each of which leaves what is sound as it is: duplicate and "
    "degenerate faces, cracks and T-junctions at borders, edges and vertices that are not manifold, orientation, small pieces, "
    "holes, and self-intersections, again until no check found a fault. The job would have been refused if the volume had "
    "changed by more than {volume:g} %, the area by more than {area:g} %, or the surface had moved by more than "
    "{deviation:g} mm, filled holes and pieces taken away apart. "
)
OWN_NAME = "surface"  # what the algorithm calls the one surface it sees
UNMOVED_MM = 1e-6  # distances of a surface to itself are not exactly 0


def run_heal(inputs: HealInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """Fit surfaces, and what was changed where and how far.

    Each surface is mended for itself: whether several cross each other is left for the verdict.
    Raises: InputError `heal.*`, `package.*`; InternalError `heal.not_proven` with a report.
    """
    source = load_surfaces(inputs, meshes, run.stage("load", 0.0, 0.03))
    before = validate_once(source.meshes, inputs.min_gap_mm, run.stage("look at the surfaces", 0.03, 0.13))
    step, count = run.stage("heal", 0.13, 0.6), len(source.meshes)
    healed = {
        name: heal_surface(
            name, mesh, inputs, step.stage(f"heal: {name}", number / count, (number + 1) / count), alone=count == 1
        )
        for number, (name, mesh) in enumerate(source.meshes.items())
    }

    def find_broken(after: Validation, _deviations: object) -> list[str]:
        faults = [
            finding for finding in after.findings if finding.severity is Severity.ERROR and finding.code.startswith("mesh.")
        ]
        broken = [finding.message for finding in faults]
        if before.verdict == "simulation_ready" and not inputs.staircase:
            for name, result in healed.items():
                if before.meshes[name].components == 1 and not _is_same(source.meshes[name], result.mesh):
                    broken.append(f"{name} was fit, but was changed")
            broken += find_regressions(before, after, inputs.min_gap_mm) if not broken else []
        return broken

    job = SurfaceJob(
        process="heal",
        not_proven="heal.not_proven",
        source=source,
        before=before,
        made={name: result.mesh for name, result in healed.items()},
        min_gap_mm=inputs.min_gap_mm,
        summary=lambda report: healing_summary(report, before, healed),
        find_broken=find_broken,
        methods=healing_methods(inputs),
        references=VALIDATE_REFERENCES,
        parameters=inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"}),
        changes=tuple({"mesh": name, **change} for name, result in healed.items() for change in result.changes),
        findings=tuple(_renamed(finding, name) for name, result in healed.items() for finding in result.findings),
        draw=lambda report: draw_change_places({name: healed[name].mesh for name in report.meshes}, report.changes),
    )
    return deliver_surfaces(job, run.stage("deliver", 0.6, 1.0), out_dir)


def healing_methods(inputs: HealInputs) -> str:
    """Citable; numbers are those of `REFERENCES` of `validate`."""
    limits = {
        "volume": 100 * inputs.max_volume_change,
        "area": 100 * inputs.max_area_change,
        "deviation": inputs.max_deviation_mm,
    }
    return METHODS.format(**limits) + PROOF


def heal_surface(name: str, mesh: Mesh, inputs: HealInputs, run: RunContext, *, alone: bool) -> Healed:
    """One surface, resumable; a refusal says which one it is about. Raises: InputError `heal.*`."""
    asked = inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"})
    try:
        return run.checkpoint("heal", lambda: heal(mesh, inputs, run), mesh, asked)
    except IntegumentError as error:
        said = error.message if alone else f"{name}: {error.message}"
        findings = tuple(_renamed(finding, name) for finding in error.findings)
        raise type(error)(error.code, said, findings=findings, report=error.report, **error.facts) from error


def _renamed(finding: Finding, name: str) -> Finding:
    places = tuple(place.model_copy(update={"mesh": name}) for place in finding.places)
    return finding.model_copy(update={"places": places, "message": finding.message.replace(f"'{OWN_NAME}'", f"'{name}'")})


def _is_same(source: Mesh, result: Mesh) -> bool:
    return np.array_equal(source.vertices, result.vertices) and np.array_equal(source.faces, result.faces)


def healing_summary(report: Report, before: Validation, healed: Mapping[str, Healed]) -> str:
    """One sentence; of `report` meshes and comparisons count."""
    faults = sum(finding.count for finding in before.findings if finding.severity is Severity.ERROR)
    rows = []
    for name, comparison in report.comparisons.items():
        if not healed[name].changes:
            rows.append(f"{name}: nothing to mend, unchanged")
            continue
        kinds = ", ".join(
            dict.fromkeys(change["kind"].replace("_", " ") for change in healed[name].changes if "places" in change)
        )
        kept = comparison.kept_vertices / max(1, report.meshes[name].vertices)
        share = min(100 * kept, 99.99) if kept < 1 else 100
        rows.append(f"{name}: mended {kinds}; {share:.4g} % of the vertices are those that came{_moved(healed[name])}")
    return f"{counted(faults, 'fault')} found. {'; '.join(rows)}."


def _moved(result: Healed) -> str:
    """How far the surface moved, as the limit counts it: pieces taken away and patches over holes apart."""
    extents = [change for change in result.changes if change["kind"] == "extent"]
    if not extents:
        return ""
    farthest = max(float(extents[-1]["lost_mm"]), float(extents[-1]["gained_mm"]))
    return f", and elsewhere the surface moved by {farthest:.2g} mm at most" if farthest > UNMOVED_MM else ""
