"""The process `prepare`: from a skin to a model, step by step; what is done is not done twice, and is left if a step fails."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from core.errors import IntegumentError
from core.processes.loaded_skin import LoadedSkin, load_rounded
from core.processes.named_input import NamedInput, load_input
from core.processes.outcome import Outcome
from core.processes.preparation.delivery import Prepared, as_tissues, deliver, report_what_is_done
from core.processes.preparation.detach_step import detach_parts
from core.processes.preparation.ears_step import fit_ears_of
from core.processes.preparation.layers_step import make_layers_of
from core.processes.preparation.left_files import LeftFiles
from core.processes.preparation.proof_step import prove_surfaces
from core.processes.preparation.separate_step import separate_tissues
from core.processes.preparation.skin_steps import SKIN, decimate_skin, heal_skin, smooth_skin
from core.processes.preparation.step_log import BEGIN, StepLog
from core.processes.preparation.tetrahedra_step import fill_all
from core.processes.preparation.tissues_step import check_tissues
from core.processes.tissue_filling import require_known_tissues
from core.run import RunContext
from core.schema.prepare import PrepareInputs
from core.validation.requirements import require_fit_skin

Meshes = Mapping[str, Mapping[str, Any]]


def run_prepare(inputs: PrepareInputs, meshes: Meshes, run: RunContext, out_dir: Path) -> Outcome:
    """A package of skin, layers and inner tissues, proven, and tetrahedra.

    Raises: what the steps raise (`core.processes.preparation`): with a report of all steps, the surfaces as the last finished
    step left them as outputs, and the record of the steps.
    """
    left = LeftFiles(run, out_dir)
    log = StepLog(run, left.keep)
    parameters: dict[str, Any] = {}
    try:
        outcome = _prepare(inputs, meshes, run, log, parameters, out_dir)
        return replace(outcome, files=(*outcome.files, left.record(log)))
    except IntegumentError as error:
        log.fail(error)
        error.outputs = tuple(file.listed(out_dir) for file in left.keep(log))
        report_what_is_done(error, log, parameters)
        raise


def _prepare(
    inputs: PrepareInputs, meshes: Meshes, run: RunContext, log: StepLog, parameters: dict[str, Any], out_dir: Path
) -> Outcome:
    """One step after the other; `parameters` are filled in as they become known."""
    load = run.stage("load", 0.0, BEGIN)
    source = load_rounded(inputs.skin.href, meshes)
    solids = [load_input(reference.href, meshes) for reference in inputs.canals]
    inner = {tissue.name: load_input(tissue.mesh.href, meshes) for tissue in inputs.tissues}
    load.advance(1.0, f"skin '{source.name}': {len(source.mesh.faces)} faces; {len(inner)} inner tissues, {len(solids)} canals")
    parameters |= _parameters(inputs, source, solids, inner)
    if inputs.tetrahedra is not None:
        require_known_tissues(inputs.tetrahedra, [SKIN, *(layer.name for layer in inputs.layers), *inner])
    log.surfaces = {SKIN: source.mesh}
    if inputs.heal is None:
        require_fit_skin(source.mesh, SKIN)
    healed = heal_skin(inputs, source.mesh, log)
    skin = smooth_skin(inputs, detach_parts(inputs, decimate_skin(inputs, healed, log), log), log)
    inner_meshes = check_tissues(inputs, inner, skin, log)
    ears = fit_ears_of(inputs, skin, healed, solids, log)
    if ears is not None:
        skin = ears.skin.mesh
        parameters["regions"] = [region.model_dump(mode="json") for region in (*ears.regions, *inputs.regions)]
    layers = make_layers_of(inputs, source, skin, ears, log)
    inner_meshes = separate_tissues(inputs, layers.surfaces(), inner_meshes, log)
    delivered, validation = prove_surfaces(inputs, layers.surfaces(), inner_meshes, log, out_dir)
    tissues = as_tissues(inputs, layers, inner_meshes, validation)
    volume, regions = fill_all(inputs, tissues, validation, log)
    made = Prepared(inputs, layers, delivered, validation, tissues, volume, regions, parameters, source.changes)
    return log.time("package", lambda stage: deliver(made, log, stage, out_dir))


def _parameters(
    inputs: PrepareInputs, source: LoadedSkin, solids: Sequence[NamedInput], inner: Mapping[str, NamedInput]
) -> dict[str, Any]:
    """As sent, with meshes by name and checksum."""
    return {
        **inputs.model_dump(mode="json", exclude={"skin", "canals", "tissues"}),
        "skin": {"name": source.name, "sha256": source.sha256},
        "canals": [{"name": solid.name, "sha256": solid.sha256} for solid in solids],
        "tissues": {
            tissue.name: {
                **tissue.model_dump(mode="json", exclude={"name", "mesh"}),
                "mesh": inner[tissue.name].name,
                "sha256": inner[tissue.name].sha256,
            }
            for tissue in inputs.tissues
        },
    }
