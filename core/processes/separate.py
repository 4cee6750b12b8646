"""The process `separate`: a thin gap between tissues that cross or touch, proven on the files that are delivered."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from core.processes.loaded_surfaces import LoadedSurfaces, load_surfaces
from core.processes.outcome import Outcome
from core.processes.proof import validate_once
from core.processes.surface_package import PROOF, SurfaceJob, deliver_surfaces
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.figures.change_places import draw_change_places
from core.reports.figures.figure import Figure
from core.reports.figures.opened_gaps import draw_opened_gaps
from core.reports.palette import tissue_colours
from core.run import RunContext
from core.schema.finding import Severity
from core.schema.report import PairReport, Report
from core.schema.separate import SeparateInputs
from core.separation.account import describe
from core.separation.relations import Relation
from core.separation.separate import Separation, separate
from core.validation.validate import Validation

METHODS = (
    "Which tissue holds which was {told} by where most of each surface lies. Around intersections, and where two surfaces were "
    "closer than {gap:g} mm, vertices were moved step by step along the mean normal of Eq. (4.1) of [3], inwards on a tissue "
    "inside or beside the other, outwards on one around it; both went half of the way unless one was fixed or had priority. "
    "No step let a surface cross itself, turned a face over or made it a sliver. In the end every vertex went back as far "
    "towards its former place as the gap allows. "
)
REFERENCES = (
    *VALIDATE_REFERENCES,
    "[3] A. T. Htet, Full-body Shell Creation for CAD Virtual Humans including Tightly-Spaced, Enclosed Shells, "
    "Worcester Polytechnic Institute",
)
AS_REPORTED: Mapping[Relation, str] = {"inside": "a_inside_b", "around": "b_inside_a", "beside": "disjoint"}


def run_separate(inputs: SeparateInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """Surfaces with a gap between every two of them.

    Raises: InputError `surface.*`, `separate.*`, `package.*`; InternalError `separate.not_proven` with a report.
    """
    source = load_surfaces(inputs, meshes, run.stage("load", 0.0, 0.03))
    before = validate_once(source.meshes, inputs.min_gap_mm, run.stage("look at the surfaces", 0.03, 0.13))
    step = run.stage("separate", 0.13, 0.6)
    asked = inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"})
    made = step.checkpoint("separate", lambda: separate(source.meshes, inputs, step), source.meshes, asked)
    job = SurfaceJob(
        process="separate",
        not_proven="separate.not_proven",
        source=source,
        before=before,
        made={name: tissue.mesh for name, tissue in made.tissues.items()},
        min_gap_mm=inputs.min_gap_mm,
        summary=lambda report: _summary(report, before, made),
        find_broken=lambda after, _deviations: find_broken(inputs, source, made, after),
        methods=METHODS.format(told="told, or found" if inputs.inside else "found", gap=inputs.min_gap_mm) + PROOF,
        references=REFERENCES,
        parameters=asked,
        changes=describe(made, inputs),
        draw=lambda report: _draw(made, report),
    )
    return deliver_surfaces(job, run.stage("deliver", 0.6, 1.0), out_dir)


def find_broken(inputs: SeparateInputs, source: LoadedSurfaces, made: Separation, after: Validation) -> list[str]:
    """What the delivered surfaces, as validated, break of the promise, in words."""
    broken = [finding.message for finding in after.findings if finding.severity is Severity.ERROR]
    for pair in after.pairs:
        wanted = AS_REPORTED[made.relations[pair.a, pair.b]]
        if pair.relation != wanted:
            broken.append(f"{pair.a} and {pair.b} lie {pair.relation}, not {wanted}")
    moved = [name for name in inputs.fixed if not np.array_equal(source.meshes[name].vertices, made.tissues[name].mesh.vertices)]
    return [*broken, *(f"{name} is fixed, but was moved" for name in moved)]


def _summary(report: Report, before: Validation, made: Separation) -> str:
    crossing = sum(pair.intersecting_pairs for pair in before.pairs)
    shifts = {name: tissue.shift_mm[tissue.shift_mm > 0.0] for name, tissue in made.tissues.items()}
    rows = [
        f"{name}: {len(shift)} vertices by {shift.mean():.3g} mm, {shift.max():.3g} mm at most"
        for name, shift in shifts.items()
        if len(shift)
    ]
    moved = f"Moved {'; '.join(rows)}" if rows else "Nothing had to move"
    return f"{_apart(report.pairs)}, where there were {crossing} intersecting pairs of faces. {moved}."


def _draw(made: Separation, report: Report) -> tuple[Figure, ...]:
    """Sections before and after, then all places circled."""
    before = {name: made.tissues[name].original for name in report.meshes}
    after = {name: made.tissues[name].mesh for name in report.meshes}
    parted = draw_opened_gaps(before, after, tissue_colours(list(after)))
    return (*([parted] if parted else []), *draw_change_places(after, report.changes))


def _apart(pairs: tuple[PairReport, ...]) -> str:
    gaps = [pair.min_gap_mm for pair in pairs if pair.min_gap_mm is not None]
    return f"No two surfaces intersect, the smallest gap is {min(gaps):.3f} mm"
