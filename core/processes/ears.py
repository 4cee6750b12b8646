"""The process `ears`: canals cut into a skin, thinner layers in the ears, otherwise as `shells`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from numpy import float64
from numpy.typing import NDArray

from core.geometry.body_frame import find_body_frame
from core.geometry.vertex_values import interpolate
from core.processes.ear_fitting import draw_fitted_ears, ear_changes, ear_findings, ear_methods, fit_ears
from core.processes.layer_package import LayerJob, deliver_layers
from core.processes.loaded_skin import LoadedSkin, load_skin
from core.processes.named_input import NamedInput, load_input
from core.processes.outcome import Outcome
from core.processes.shells import REFERENCES, methods_text
from core.run import RunContext
from core.schema.ears import EarsInputs
from core.schema.shells import Region


def run_ears(inputs: EarsInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """Ears, canals, then all that `shells` does.

    Raises: InputError `ears.*`, `canal.*` and those of `run_shells`; InternalError `canal.seam_not_proven`,
    `shells.not_proven`.
    """
    source = load_skin(inputs.skin.href, meshes, run)
    solids = [load_input(reference.href, meshes) for reference in inputs.canals]
    fitted = fit_ears(inputs, source.mesh, solids, run.stage("ears", 0.06, 0.16))
    skin, frame = fitted.skin, find_body_frame(source.mesh)
    job = LayerJob(
        process="ears",
        skin=skin.mesh,
        inputs=inputs.as_shells(fitted.regions),
        methods=ear_methods(fitted, inputs) + methods_text(inputs.as_shells(())),
        references=REFERENCES,
        parameters=_parameters(inputs, source, solids, fitted.regions),
        changes=(*source.changes, *ear_changes(fitted)),
        arrays={
            name: interpolate(values, source.mesh, skin.mesh.vertices) for name, values in _asked_for(inputs, source).items()
        },
        describe=lambda shells: ear_findings(fitted, shells),
        draw=lambda surfaces: draw_fitted_ears(fitted, frame, surfaces),
    )
    return deliver_layers(job, run.stage("layers", 0.16, 1.0), out_dir)


def _asked_for(inputs: EarsInputs, source: LoadedSkin) -> Mapping[str, NDArray[float64]]:
    """The arrays that layers name; in the wall of a canal, which the upload does not know, the skin nearest to it counts."""
    named = {layer.depth_array for layer in inputs.layers}
    return {name: values for name, values in source.arrays.items() if name in named}


def _parameters(inputs: EarsInputs, source: LoadedSkin, solids: list[NamedInput], regions: tuple[Region, ...]) -> dict[str, Any]:
    """As sent, with meshes by name and checksum, and the regions used: they can be sent to `shells` or `ears` again."""
    return {
        **inputs.model_dump(mode="json", exclude={"skin", "canals"}),
        "regions": [region.model_dump(mode="json") for region in (*regions, *inputs.regions)],
        "skin": {"name": source.name, "sha256": source.sha256},
        "canals": [{"name": solid.name, "sha256": solid.sha256} for solid in solids],
    }
