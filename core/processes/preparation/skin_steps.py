"""The steps that turn a skin into a better one: `heal`, `decimate`, `smooth`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

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
from core.schema.model import FrozenModel
from core.schema.prepare import PrepareInputs
from core.schema.report import Report, StepReport
from core.smoothing.smooth import smooth
from core.validation.comparison import compare_with_original
from core.validation.requirements import require_fit_skin
from core.validation.validate import Validation, validate

SKIN = "skin"


class Changed(Protocol):
    """What the work of a step gives."""

    @property
    def mesh(self) -> Mesh: ...
    @property
    def changes(self) -> tuple[dict[str, Any], ...]: ...
    @property
    def findings(self) -> tuple[Finding, ...]: ...


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
    made = _change("heal", skin, asked, log, lambda run: heal_surface(SKIN, skin, asked, run, alone=True))
    healed = Healed(made.mesh, np.empty(0, dtype=np.int64), made.changes, made.findings)
    faults = sum(finding.count for finding in made.before.findings if finding.severity is Severity.ERROR)
    _tell(
        log,
        "heal",
        skin,
        made,
        summary=healing_summary(_mini_report("heal", skin, made), made.before, {SKIN: healed}),
        numbers={"faults found": faults},
        methods=healing_methods(asked) if made.changes else "",
        references=VALIDATE_REFERENCES,
        draw=lambda _surfaces: (*_compared("heal", skin, made), *draw_change_places({SKIN: made.mesh}, _of_skin(made.changes))),
    )
    return made.mesh


def decimate_skin(inputs: PrepareInputs, skin: Mesh, log: StepLog) -> Mesh:
    """Thinned out. Raises: InputError `surface.*`, `region.*`, `decimate.*`, `skin.*` if `literal` broke it."""
    if inputs.decimate is None:
        log.leave_out("decimate", "not asked for")
        return skin
    asked = inputs.as_decimate()
    made = _change("decimate", skin, asked, log, lambda run: decimate({SKIN: skin}, asked, run)[SKIN])
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
    made = _change("smooth", skin, asked, log, lambda run: smooth({SKIN: skin}, asked, run)[SKIN])
    lowest = [found.meshes[SKIN].quality.minimum for found in (made.before, made.after)]
    # vertices keep their numbers; the surface between them deviates more where edges are flipped
    shift = float(np.linalg.norm(made.mesh.vertices - skin.vertices, axis=1).max())
    _tell(
        log,
        "smooth",
        skin,
        made,
        summary=f"Lowest quality {lowest[0]:.2g} to {lowest[1]:.2g}, vertices moved by up to {shift:.3g} mm, deviation of the "
        f"surface up to {made.deviation.maximum_mm:.3g} mm.",
        numbers={
            "lowest quality before": lowest[0],
            "lowest quality after": lowest[1],
            "largest way of a vertex [mm]": round(shift, 6),
        },
        methods=smoothing_methods(asked, together=False),
        references=SMOOTH_REFERENCES,
        draw=lambda _surfaces: _compared("smooth", skin, made),
    )
    return made.mesh


def _change(name: str, skin: Mesh, asked: FrozenModel, log: StepLog, make: Callable[[RunContext], Changed]) -> ChangedSkin:
    """The skin looked at, changed, and compared; what is handed on is fit. Raises: what `make` raises, InputError `skin.*`."""

    def work(run: RunContext) -> ChangedSkin:
        before = validate({SKIN: skin}, run=run.stage(f"{name}: look at the skin", 0.0, 0.2))
        made = _compare(skin, make(run.stage(name, 0.2, 0.8)), before, run.stage(f"{name}: compare", 0.8, 1.0))
        if made.after.verdict != "simulation_ready" or made.after.meshes[SKIN].components != 1:
            require_fit_skin(made.mesh, SKIN)  # says by name what is left
        return made

    return log.take(name, work, skin, asked.model_dump(mode="json", exclude={"mesh"}))


def _compare(skin: Mesh, made: Changed, before: Validation, run: RunContext) -> ChangedSkin:
    """Checked and measured; a skin that is the same needs no second look."""
    same = np.array_equal(skin.vertices, made.mesh.vertices) and np.array_equal(skin.faces, made.mesh.faces)
    after = before if same else validate({SKIN: made.mesh}, run=run)
    return ChangedSkin(made.mesh, before, after, measure_deviation(skin, made.mesh), made.changes, made.findings)


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
