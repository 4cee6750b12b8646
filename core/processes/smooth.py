"""The process `smooth`: better triangles or less noise, the surface kept sound, proven on the files that are delivered."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.processes.loaded_surfaces import load_surfaces
from core.processes.outcome import Outcome
from core.processes.proof import validate_once
from core.processes.surface_package import PROOF, SurfaceJob, deliver_surfaces
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.figures.smoothing_course import draw_smoothing_course
from core.reports.palette import tissue_colours
from core.run import RunContext
from core.schema.counted import counted
from core.schema.report import Report
from core.schema.smooth import SmoothInputs
from core.smoothing.smooth import smooth
from core.validation.regressions import find_regressions

METHODS = {
    "standard": "Vertices were moved to the mean of their neighbours (standard Laplacian smoothing, Eq. 3.1 of [3])",
    "lumped": "Vertices were moved as lumped Laplacian smoothing has it (Eq. 3.2 of [3])",
    "cvt": "Vertices were moved towards centroids of the triangles around them (CVT smoothing, Eq. 3.3 of [3])",
    "wcc": "Vertices were moved towards the weighted circumcentres of the triangles around them (WCC smoothing, Eq. 3.4 of [3])",
    "hc": "Laplacian smoothing was followed by a push back towards the former places, which takes its shrinkage away (HC, [4])",
    "taubin": "Every Laplacian step inwards was followed by a larger one outwards, which takes its shrinkage away [5]",
}
GUARDS = (
    ", all vertices at once. Steps that would have turned a face over, folded the surface or let it cross itself{together} were "
    "shortened. "
)
TOGETHER = " or come nearer to another surface than {gap:g} mm"
STOPS = {
    "quality": "Iterations ended when the lowest triangle quality no longer rose; the best state was taken. ",
    "iterations": "All iterations asked for were made. ",
}
REFERENCES = (
    *VALIDATE_REFERENCES,
    "[3] A. T. Htet, Full-body Shell Creation for CAD Virtual Humans including Tightly-Spaced, Enclosed Shells, "
    "Worcester Polytechnic Institute",
    "[4] J. Vollmer, R. Mencl, H. Müller, Improved Laplacian smoothing of noisy surface meshes, Computer Graphics Forum 18, "
    "1999, doi:10.1111/1467-8659.00334",
    "[5] G. Taubin, A signal processing approach to fair surface design, SIGGRAPH 1995, doi:10.1145/218380.218473",
)


def run_smooth(inputs: SmoothInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """Smoothed surfaces, and the proof that they are as sound as they came.

    An open surface is smoothed, too, and stays open: the verdict says so.
    Raises: InputError `surface.*`, `surfaces.too_close`, `region.outside_mesh`, `package.*`; InternalError
    `smooth.not_proven` with a report.
    """
    source = load_surfaces(inputs, meshes, run.stage("load", 0.0, 0.03))
    before = validate_once(source.meshes, inputs.min_gap_mm, run.stage("look at the surfaces", 0.03, 0.13))
    step = run.stage("smooth", 0.13, 0.6)
    asked = inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"})
    made = step.checkpoint("smooth", lambda: smooth(source.meshes, inputs, step), source.meshes, asked)
    courses = {name: result.progress for name, result in made.items()}
    delivered = {name: result.delivered for name, result in made.items()}
    job = SurfaceJob(
        process="smooth",
        not_proven="smooth.not_proven",
        source=source,
        before=before,
        made={name: result.mesh for name, result in made.items()},
        min_gap_mm=inputs.min_gap_mm,
        summary=lambda report: _summary(report, delivered),
        find_broken=lambda after, _deviations: find_regressions(before, after, inputs.min_gap_mm),
        methods=smoothing_methods(inputs, together=len(made) > 1),
        references=REFERENCES,
        parameters=asked,
        changes=tuple({"mesh": name, **change} for name, result in made.items() for change in result.changes),
        findings=tuple(finding for result in made.values() for finding in result.findings),
        draw=lambda report: (draw_smoothing_course(courses, delivered, tissue_colours(list(report.meshes))),),
    )
    return deliver_surfaces(job, run.stage("deliver", 0.6, 1.0), out_dir)


def _summary(report: Report, delivered: Mapping[str, int]) -> str:
    rows = []
    for name, comparison in report.comparisons.items():
        before, after = comparison.before.quality, report.meshes[name].quality
        drift = "" if comparison.volume_change is None else f", volume {100 * comparison.volume_change:+.3f} %"
        done = counted(delivered[name], "iteration")
        rows.append(
            f"{name}: lowest quality {before.minimum:.3g} to {after.minimum:.3g} in {done}{drift}, "
            f"deviation up to {comparison.deviation.maximum_mm:.3g} mm"
            if delivered[name]
            else f"{name} stays as it was: no iteration raised its lowest quality, {before.minimum:.3g}"
        )
    return f"{'; '.join(rows)}."


def smoothing_methods(inputs: SmoothInputs, *, together: bool) -> str:
    """Citable; numbers are those of `REFERENCES`."""
    guards = GUARDS.format(together=TOGETHER.format(gap=inputs.min_gap_mm) if together else "")
    return METHODS[inputs.method] + guards + STOPS[inputs.stop] + PROOF
