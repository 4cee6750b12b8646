"""The step `ears`: ears found or taken as boxes, canals cut into the skin."""

from __future__ import annotations

from collections.abc import Sequence

from core.geometry.body_frame import find_body_frame
from core.mesh import Mesh
from core.processes.ear_fitting import FittedEars, draw_fitted_ears, ear_changes, ear_methods, fit_ears
from core.processes.named_input import NamedInput
from core.processes.preparation.skin_steps import SKIN
from core.processes.preparation.step_log import STEPS, StepLog
from core.processes.shells import REFERENCES
from core.schema.prepare import PrepareInputs
from core.schema.report import StepReport


def fit_ears_of(
    inputs: PrepareInputs, skin: Mesh, seen_on: Mesh, solids: Sequence[NamedInput], log: StepLog
) -> FittedEars | None:
    """None if nobody asked for ears; seen_on: the skin before it was thinned out.

    Raises: InputError `ears.*`, `canal.*`; InternalError `canal.seam_not_proven`.
    """
    if inputs.ears is None:
        log.leave_out("ears", "not asked for")
        return None
    asked = inputs.as_ears()
    named = [(solid.name, solid.mesh) for solid in solids]
    decisive = asked.model_dump(mode="json", exclude={"skin", "canals"})
    fitted = log.take("ears", lambda run: fit_ears(asked, skin, solids, run, seen_on), skin, seen_on, named, decisive)
    frame = find_body_frame(skin)
    names = ", ".join(region.name for region in fitted.ears)
    cut = (
        f"{len(fitted.canals)} canals cut into the skin, seams remeshed within {fitted.skin.moved_mm:.2g} mm of what was given, "
        f"lowest quality of new faces {fitted.skin.lowest_quality:.2g}."
        if fitted.canals
        else "No canals."
    )
    log.tell(
        StepReport(
            name="ears",
            title=STEPS["ears"][0],
            summary=f"{'Found' if asked.ears == 'auto' else 'Given'}: {names}. {cut}",
            numbers={
                "ears": len(fitted.ears),
                "canals": len(fitted.canals),
                "faces before": len(skin.faces),
                "faces after": len(fitted.skin.mesh.faces),
            },
            changes=ear_changes(fitted),
            methods=ear_methods(fitted, asked),
            references=REFERENCES,
            parameters={"regions": [region.model_dump(mode="json") for region in fitted.regions]},
        ),
        {SKIN: fitted.skin.mesh},
        lambda surfaces: draw_fitted_ears(fitted, frame, surfaces),
    )
    return fitted
