"""The process `decimate`: fewer faces, alone or a whole nested set, proven on the files that are delivered."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.decimation.decimate import decimate
from core.geometry.deviation import Deviation
from core.processes.loaded_surfaces import load_surfaces
from core.processes.outcome import Outcome
from core.processes.proof import validate_once
from core.processes.surface_package import PROOF, SurfaceJob, deliver_surfaces
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.wording import whole
from core.run import RunContext
from core.schema.decimate import DecimateInputs
from core.schema.report import Report
from core.validation.regressions import find_regressions
from core.validation.validate import Validation

PRIORITY = {
    "curvature": (
        "Edges were collapsed where the surface is flattest first, by the mean angle between the normal of a face and those of "
        "its neighbours, the priority of [3], Chapter 3"
    ),
    "quadric": "Edges were collapsed where that changes the squared distances to the former faces' planes least first [4]",
}
GUARDS = (
    ". A collapse was made only where it keeps the topology (link condition [5]), turns no face over, leaves no sliver and "
    "brings no two faces into each other's way{together}. "
)
TOGETHER = ", nor two surfaces nearer to each other than {gap:g} mm"
LITERAL = (
    "Appendix A of [3] was carried out step for step: the shortest edge of the flattest face is merged into its second corner, "
    "and the vertices of two rings around are smoothed, without any guard. The result was checked; nothing is promised of it. "
)
REFERENCES = (
    *VALIDATE_REFERENCES,
    "[3] A. T. Htet, Full-body Shell Creation for CAD Virtual Humans including Tightly-Spaced, Enclosed Shells, "
    "Worcester Polytechnic Institute",
    "[4] M. Garland, P. S. Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997, "
    "doi:10.1145/258734.258849",
    "[5] T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, Topology preserving edge contraction, Publications de l'Institut "
    "Mathématique 66, 1999",
)
ROUNDING = 1e-6  # of the limit of deviation: distances are sums in float64


def run_decimate(inputs: DecimateInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """Fewer faces, and the proof that the surfaces are as sound as they came.

    Raises: InputError `surface.*`, `surfaces.too_close`, `region.*`, `decimate.*`, `package.*`; InternalError
    `decimate.not_proven` with a report.
    """
    source = load_surfaces(inputs, meshes, run.stage("load", 0.0, 0.03))
    before = validate_once(source.meshes, inputs.min_gap_mm, run.stage("look at the surfaces", 0.03, 0.13))
    made = decimate(source.meshes, inputs, run.stage("decimate", 0.13, 0.6))

    def find_broken(after: Validation, deviations: Mapping[str, Deviation]) -> list[str]:
        if inputs.literal:
            return []
        broken = find_regressions(before, after, inputs.min_gap_mm)
        if inputs.max_deviation_mm is not None:
            limit = inputs.max_deviation_mm * (1.0 + ROUNDING)
            broken += [
                f"{name} deviates by {deviation.maximum_mm:.6g} mm"
                for name, deviation in deviations.items()
                if deviation.maximum_mm > limit
            ]
        return broken

    job = SurfaceJob(
        process="decimate",
        not_proven="decimate.not_proven",
        source=source,
        before=before,
        made={name: result.mesh for name, result in made.items()},
        min_gap_mm=inputs.min_gap_mm,
        summary=decimation_summary,
        find_broken=find_broken,
        methods=decimation_methods(inputs, together=len(made) > 1),
        references=REFERENCES,
        parameters=inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"}),
        changes=tuple({"mesh": name, **change} for name, result in made.items() for change in result.changes),
        findings=tuple(finding for result in made.values() for finding in result.findings),
    )
    return deliver_surfaces(job, run.stage("deliver", 0.6, 1.0), out_dir)


def decimation_summary(report: Report) -> str:
    """One sentence; of `report` meshes, pairs and comparisons count."""
    rows = [
        f"{name}: {whole(comparison.before.faces)} to {whole(report.meshes[name].faces)} faces, "
        f"deviation up to {comparison.deviation.maximum_mm:.3g} mm ({comparison.deviation.rms_mm:.2g} mm rms)"
        for name, comparison in report.comparisons.items()
    ]
    crossing = sum(mesh.self_intersecting_pairs for mesh in report.meshes.values())
    crossing += sum(pair.intersecting_pairs for pair in report.pairs)
    gaps = [pair.min_gap_mm for pair in report.pairs if pair.min_gap_mm is not None]
    apart = f", smallest gap {min(gaps):.3f} mm" if gaps else ""
    return f"{'; '.join(rows)}. {crossing} intersecting pairs of faces{apart}."


def decimation_methods(inputs: DecimateInputs, *, together: bool) -> str:
    """Citable; numbers are those of `REFERENCES`."""
    if inputs.literal:
        return LITERAL + PROOF
    return PRIORITY[inputs.method] + GUARDS.format(together=TOGETHER.format(gap=inputs.min_gap_mm) if together else "") + PROOF
