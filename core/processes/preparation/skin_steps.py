"""The steps that turn a skin into a better one: `heal`, `decimate`, `smooth`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from core.decimation.decimate import decimate
from core.geometry.deviation import Deviation, measure_deviation
from core.healing.heal import Healed
from core.mesh import Mesh
from core.processes.decimate import REFERENCES as DECIMATE_REFERENCES
from core.processes.decimate import decimation_methods, decimation_summary
from core.processes.heal import heal_surface, healing_methods, healing_summary
from core.processes.preparation.step_log import STEPS, Draw, StepLog
from core.processes.smooth import REFERENCES as SMOOTH_REFERENCES
from core.processes.smooth import smoothing_methods
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.figures.change_places import draw_change_places
from core.reports.figures.compare import draw_comparison
from core.reports.figures.figure import Figure
from core.run import RunContext
from core.schema.finding import Finding, Severity
from core.schema.prepare import PrepareInputs
from core.schema.report import Report, StepReport
from core.smoothing.smooth import smooth
from core.validation.comparison import compare_with_original
from core.validation.requirements import require_fit_skin
from core.validation.validate import Validation, validate

SKIN = "skin"


@dataclass(frozen=True, eq=False, slots=True)
class ChangedSkin:
    """What a step made of a skin. before, after: all checks on both, the same one if nothing changed."""

    mesh: Mesh
    before: Validation
    after: Validation
    deviation: Deviation
    changes: tuple[dict[str, Any], ...]
    findings: tuple[Finding, ...]


def heal_skin(inputs: PrepareInputs, skin: Mesh, log: StepLog) -> Mesh:
    """Mended, or refused. Raises: InputError `heal.*`, `skin.*`."""
    if inputs.heal is None:
        log.leave_out("heal", "not asked for: the skin was fit as it came")
        return skin
    asked = inputs.as_heal()

    def work(run: RunContext) -> ChangedSkin:
        before = validate({SKIN: skin}, run=run.stage("heal: look at the skin", 0.0, 0.2))
        healed = heal_surface(SKIN, skin, asked, run.stage("heal", 0.2, 0.8), alone=True)
        made = _changed(skin, healed.mesh, before, healed.changes, healed.findings, run.stage("heal: compare", 0.8, 1.0))
        if made.after.verdict != "simulation_ready" or made.after.meshes[SKIN].components != 1:
            require_fit_skin(made.mesh, SKIN)  # says by name what is left
        return made

    made = log.take("heal", work, skin, asked.model_dump(mode="json", exclude={"mesh"}))
    healed = Healed(made.mesh, np.empty(0, dtype=np.int64), made.changes, made.findings)
    report = _mini_report("heal", skin, made)
    faults = sum(finding.count for finding in made.before.findings if finding.severity is Severity.ERROR)
    _tell(
        log,
        "heal",
        skin,
        made,
        summary=healing_summary(report, made.before, {SKIN: healed}),
        numbers={"faults found": faults},
        methods=healing_methods(asked) if made.changes else "",
        references=VALIDATE_REFERENCES,
        draw=lambda _surfaces: (*_compared("heal", skin, made), *draw_change_places({SKIN: made.mesh}, _of_skin(made.changes))),
    )
    return made.mesh


def decimate_skin(inputs: PrepareInputs, skin: Mesh, log: StepLog) -> Mesh:
    """Thinned out. Raises: InputError `surface.*`, `region.*`, `decimate.*`."""
    if inputs.decimate is None:
        log.leave_out("decimate", "not asked for")
        return skin
    asked = inputs.as_decimate()

    def work(run: RunContext) -> ChangedSkin:
        before = validate({SKIN: skin}, run=run.stage("decimate: look at the skin", 0.0, 0.2))
        thin = decimate({SKIN: skin}, asked, run.stage("decimate", 0.2, 0.8))[SKIN]
        made = _changed(skin, thin.mesh, before, thin.changes, thin.findings, run.stage("decimate: compare", 0.8, 1.0))
        if made.after.verdict != "simulation_ready":  # `literal` promises nothing
            require_fit_skin(made.mesh, SKIN)
        return made

    made = log.take("decimate", work, skin, asked.model_dump(mode="json", exclude={"mesh"}))
    _tell(
        log,
        "decimate",
        skin,
        made,
        summary=decimation_summary(_mini_report("decimate", skin, made)),
        numbers={"mean deviation [mm, rms]": round(made.deviation.rms_mm, 6)},
        methods=decimation_methods(asked, together=False),
        references=DECIMATE_REFERENCES,
        draw=lambda _surfaces: _compared("decimate", skin, made),
    )
    return made.mesh


def smooth_skin(inputs: PrepareInputs, skin: Mesh, log: StepLog) -> Mesh:
    """With better triangles. Raises: InputError `surface.*`, `region.outside_mesh`."""
    if inputs.smooth is None:
        log.leave_out("smooth", "not asked for")
        return skin
    asked = inputs.as_smooth()

    def work(run: RunContext) -> ChangedSkin:
        before = validate({SKIN: skin}, run=run.stage("smooth: look at the skin", 0.0, 0.2))
        made = smooth({SKIN: skin}, asked, run.stage("smooth", 0.2, 0.8))[SKIN]
        return _changed(skin, made.mesh, before, made.changes, made.findings, run.stage("smooth: compare", 0.8, 1.0))

    made = log.take("smooth", work, skin, asked.model_dump(mode="json", exclude={"mesh"}))
    lowest = [found.meshes[SKIN].quality.minimum for found in (made.before, made.after)]
    _tell(
        log,
        "smooth",
        skin,
        made,
        summary=f"Lowest quality {lowest[0]:.2g} to {lowest[1]:.2g}, deviation up to {made.deviation.maximum_mm:.3g} mm.",
        numbers={"lowest quality before": lowest[0], "lowest quality after": lowest[1]},
        methods=smoothing_methods(asked, together=False),
        references=SMOOTH_REFERENCES,
        draw=lambda _surfaces: _compared("smooth", skin, made),
    )
    return made.mesh


def _changed(
    skin: Mesh,
    result: Mesh,
    before: Validation,
    changes: tuple[dict[str, Any], ...],
    findings: tuple[Finding, ...],
    run: RunContext,
) -> ChangedSkin:
    """Checked and measured; a skin that is the same needs no second look."""
    same = np.array_equal(skin.vertices, result.vertices) and np.array_equal(skin.faces, result.faces)
    after = before if same else validate({SKIN: result}, run=run)
    return ChangedSkin(result, before, after, measure_deviation(skin, result), changes, findings)


def _tell(
    log: StepLog,
    name: str,
    skin: Mesh,
    made: ChangedSkin,
    *,
    summary: str,
    numbers: dict[str, int | float | str],
    methods: str,
    references: tuple[str, ...],
    draw: Draw,
) -> None:
    report = _mini_report(name, skin, made)
    counts: dict[str, int | float | str] = {
        "faces before": len(skin.faces),
        "faces after": len(made.mesh.faces),
        "largest deviation [mm]": report.comparisons[SKIN].deviation.maximum_mm,
    }
    log.tell(
        StepReport(
            name=name,
            title=STEPS[name][0],
            summary=summary,
            numbers={**counts, **numbers},
            meshes=made.after.meshes,
            comparisons=report.comparisons,
            findings=(*made.findings, *(one for one in made.before.findings if one.severity is Severity.ERROR)),
            changes=_of_skin(made.changes),
            methods=methods,
            references=references,
        ),
        {SKIN: made.mesh},
        draw,
    )


def _mini_report(process: str, skin: Mesh, made: ChangedSkin) -> Report:
    """The report the process of that name would give, as far as its words and figures ask for it."""
    comparison = compare_with_original(skin, made.before.meshes[SKIN], made.mesh, made.after.meshes[SKIN], made.deviation)
    return Report(
        process=process,
        verdict=made.after.verdict,
        summary="",
        meshes=made.after.meshes,
        comparisons={SKIN: comparison},
        findings=made.findings,
    )


def _compared(process: str, skin: Mesh, made: ChangedSkin) -> tuple[Figure, ...]:
    return draw_comparison({SKIN: skin}, {SKIN: made.deviation}, _mini_report(process, skin, made)) if made.changes else ()


def _of_skin(changes: tuple[dict[str, Any], ...]) -> tuple[dict[str, Any], ...]:
    return tuple({"mesh": SKIN, **change} for change in changes)
