"""The step `separate`: a thin gap between inner tissues, and between them and the innermost layer, which stays as it is."""

from __future__ import annotations

from collections.abc import Mapping

from core.mesh import Mesh
from core.processes.preparation.step_log import STEPS, StepLog
from core.processes.separate import METHODS, REFERENCES
from core.reports.figures.figure import Figure
from core.reports.figures.opened_gaps import draw_opened_gaps
from core.reports.palette import tissue_colours
from core.schema.prepare import PrepareInputs
from core.schema.report import StepReport
from core.separation.account import describe
from core.separation.separate import Separation, separate


def separate_tissues(
    inputs: PrepareInputs, layers: Mapping[str, Mesh], tissues: Mapping[str, Mesh], log: StepLog
) -> dict[str, Mesh]:
    """The tissues apart. Raises: InputError `separate.*`; InternalError `separate.not_proven`."""
    if not tissues or inputs.separate is None:
        log.leave_out("separate", "there are no inner tissues" if not tissues else "not asked for")
        return dict(tissues)
    innermost = list(layers)[-1]
    asked = inputs.as_separate(innermost)
    surfaces = {innermost: layers[innermost], **tissues}
    made = log.take(
        "separate", lambda run: separate(surfaces, asked, run), surfaces, asked.model_dump(mode="json", exclude={"meshes"})
    )
    moved = {name: tissue.shift_mm[tissue.shift_mm > 0.0] for name, tissue in made.tissues.items()}
    words = "; ".join(
        f"{name}: {len(shift)} vertices by {shift.mean():.3g} mm, {shift.max():.3g} mm at most"
        for name, shift in moved.items()
        if len(shift)
    )
    changes = describe(made, asked)
    apart = {name: made.tissues[name].mesh for name in tissues}
    log.tell(
        StepReport(
            name="separate",
            title=STEPS["separate"][0],
            summary=f"{asked.min_gap_mm:g} mm between every two tissues. {f'Moved {words}' if words else 'Nothing had to move'}.",
            numbers={
                "gap [mm]": asked.min_gap_mm,
                "tissues moved": sum(bool(len(shift)) for shift in moved.values()),
                "vertices moved": sum(len(shift) for shift in moved.values()),
                "largest way of a vertex [mm]": max((float(shift.max(initial=0.0)) for shift in moved.values()), default=0.0),
            },
            changes=changes,
            methods=METHODS.format(told="told, or found" if asked.inside else "found", gap=asked.min_gap_mm),
            references=REFERENCES,
        ),
        {**layers, **apart},
        lambda _surfaces: _draw(made) if words else (),
    )
    return apart


def _draw(made: Separation) -> tuple[Figure, ...]:
    """Sections before and after."""
    before = {name: tissue.original for name, tissue in made.tissues.items()}
    after = {name: tissue.mesh for name, tissue in made.tissues.items()}
    parted = draw_opened_gaps(before, after, tissue_colours(list(after)))
    return (parted,) if parted is not None else ()
