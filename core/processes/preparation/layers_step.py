"""The step `layers`: nested shells below and around the skin."""

from __future__ import annotations

from core.geometry.vertex_values import interpolate
from core.mesh import Mesh
from core.processes.ear_fitting import FittedEars, ear_findings
from core.processes.loaded_skin import LoadedSkin
from core.processes.made_layers import MadeLayers, layer_notes, make_layers, thickness_reports
from core.processes.preparation.step_log import STEPS, StepLog
from core.processes.shells import REFERENCES, methods_text
from core.run import RunContext
from core.schema.prepare import PrepareInputs
from core.schema.report import StepReport


def make_layers_of(inputs: PrepareInputs, source: LoadedSkin, skin: Mesh, ears: FittedEars | None, log: StepLog) -> MadeLayers:
    """Raises: InputError `layer.*`, `region.*`, `skin.too_thin`, `shells.no_room`; InternalError `skin.shift_not_proven`.

    Depths that come as arrays belong to the upload; where the skin is another one since, the place of the upload nearest to it
    counts."""
    asked = inputs.as_shells(() if ears is None else ears.regions)
    named = {layer.depth_array for layer in inputs.layers}
    given = {name: values for name, values in source.arrays.items() if name in named}

    def work(run: RunContext) -> MadeLayers:
        arrays = {name: interpolate(values, source.mesh, skin.vertices) for name, values in given.items()}
        return make_layers(skin, asked, arrays, run)

    made = log.take("layers", work, skin, asked.model_dump(mode="json", exclude={"skin"}), given, source.mesh if given else None)
    thickness = thickness_reports(made, asked)
    changes, notes = layer_notes(made, asked)
    layers = "; ".join(
        f"{name} {layer.target_mm:g} mm on target on {100 * layer.on_target_area:.2f} % of its area"
        for name, layer in thickness.items()
    )
    log.tell(
        StepReport(
            name="layers",
            title=STEPS["layers"][0],
            summary=f"{len(made.shells)} layers: {layers}.",
            numbers={f"{name}, least depth [mm]": layer.min_mm for name, layer in thickness.items()}
            | {f"{name}, faces": len(mesh.faces) for name, mesh in made.surfaces().items()},
            thickness=thickness,
            findings=(*(() if ears is None else ear_findings(ears, made.shells)), *notes),
            changes=changes,
            methods=methods_text(asked),
            references=REFERENCES,
        ),
        made.surfaces(),
    )
    return made
