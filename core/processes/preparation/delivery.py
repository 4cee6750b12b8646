"""The end of `prepare`: report, figures, package and tetrahedra as files; or the report of what was done when a step failed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.errors import IntegumentError
from core.mesh import Mesh
from core.package.build import build_package
from core.package.conductivity import conductivities
from core.package.tissue import FREE_SPACE, Tissue
from core.processes.made_layers import MadeLayers, marked_areas, thickness_reports
from core.processes.outcome import Outcome, OutputFile
from core.processes.preparation.step_log import StepLog
from core.processes.software import software_versions
from core.processes.surface_package import in_nesting_order
from core.processes.tissue_filling import MSH, mesher_version, write_volume
from core.processes.written_surfaces import require_unchanged
from core.reports.figures.compose import draw_shell_figures
from core.reports.steps import joined_methods
from core.run import RunContext
from core.schema.prepare import PrepareInputs
from core.schema.report import RegionReport, Report
from core.tetrahedra.volume_mesh import VolumeMesh
from core.validation.validate import Validation

STEPS_THAT_TELL = ("ears", "layers", "tetrahedra")  # their findings are of the result, not of what was still to be changed


@dataclass(frozen=True, eq=False, slots=True)
class Prepared:
    """All that the steps made. delivered: surfaces as their files hold them; tissues: in nesting order; volume: None if nobody
    asked; parameters: of the report; changes: what loading did to the skin."""

    inputs: PrepareInputs
    layers: MadeLayers
    delivered: Mapping[str, Mesh]
    validation: Validation
    tissues: tuple[Tissue, ...]
    volume: VolumeMesh | None
    regions: Mapping[str, RegionReport]
    parameters: Mapping[str, Any]
    changes: tuple[dict[str, Any], ...]


def as_tissues(
    inputs: PrepareInputs, layers: MadeLayers, inner: Mapping[str, Mesh], validation: Validation
) -> tuple[Tissue, ...]:
    """Layers and inner tissues in nesting order, with depths and conductivities."""
    surfaces = {**layers.surfaces(), **inner}
    thickness = thickness_reports(layers, inputs.as_shells(()))
    sides = {shell.name: shell.side for shell in layers.shells}
    given = {each.name: each.conductivity_s_per_m for each in inputs.tissues if each.conductivity_s_per_m is not None}
    values = conductivities(surfaces, {**inputs.conductivities_s_per_m, **given})
    tissues = []
    for name in in_nesting_order(validation.nesting):
        depth_mm = thickness[name].target_mm if name in thickness else None
        enclosing = validation.nesting[name] or FREE_SPACE
        tissues.append(Tissue(name, surfaces[name], depth_mm, values[name], enclosing, sides.get(name)))
    return tuple(tissues)


def deliver(made: Prepared, log: StepLog, run: RunContext, out_dir: Path) -> Outcome:
    """Everything as files. Raises: InternalError `package.*`."""
    run.stage("figures", 0.0, 0.6)
    report = _report(made, log)
    depths = {shell.name: shell.depth_mm for shell in made.layers.shells}
    areas = marked_areas(made.layers)
    drawn = draw_shell_figures(made.tissues, depths, pairs=report.pairs, findings=report.findings, areas=areas)
    figures = (*drawn, *log.figures({tissue.name: tissue.mesh for tissue in made.tissues}))
    run.stage("package", 0.6, 1.0)
    package = out_dir / "package.zip"
    volume_files = () if made.volume is None else write_volume(made.tissues, made.volume, out_dir)
    packed = build_package(package, made.tissues, report, figures, depths, out_dir / MSH.path if volume_files else None)
    require_unchanged(package, made.delivered)
    files = (
        OutputFile("package", Path(package.name), "application/zip", package.name),
        *(_surface_file(tissue.name) for tissue in made.tissues),
        *volume_files,
    )
    return Outcome(packed, figures, files, {tissue.name: tissue.mesh for tissue in made.tissues}, depths)


def report_what_is_done(error: IntegumentError, log: StepLog, parameters: Mapping[str, Any]) -> None:
    """Give an error the report and figures of all steps."""
    error.figures = (*error.figures, *log.figures(log.surfaces))
    known = error.report or Report(process="prepare", verdict="not_ready", summary=error.message)
    steps = log.reports()
    methods, references = joined_methods(steps)
    error.report = known.model_copy(
        update={
            "process": "prepare",
            "steps": steps,
            "parameters": dict(parameters),
            "methods": methods,
            "references": references,
            "meshes": {name: mesh for step in steps for name, mesh in step.meshes.items()} | dict(known.meshes),
        }
    )


def _surface_file(name: str) -> OutputFile:
    return OutputFile(name, Path(f"{name}.stl"), "model/stl", f"{name}.stl")


def _report(made: Prepared, log: StepLog) -> Report:
    steps = log.reports()
    methods, references = joined_methods(steps)
    order = [tissue.name for tissue in made.tissues]
    return Report(
        process="prepare",
        verdict=made.validation.verdict,
        summary=_summary(made),
        meshes={name: made.validation.meshes[name] for name in order},
        pairs=made.validation.pairs,
        thickness=thickness_reports(made.layers, made.inputs.as_shells(())),
        regions=dict(made.regions),
        nesting=made.validation.nesting,
        findings=(
            *made.validation.findings,
            *(finding for step in steps if step.name in STEPS_THAT_TELL for finding in step.findings),
        ),
        changes=made.changes,
        steps=steps,
        methods=methods,
        references=references,
        parameters=dict(made.parameters),
        software={**software_versions(), **({} if made.volume is None else mesher_version(made.volume.mesher))},
    )


def _summary(made: Prepared) -> str:
    gaps = [pair.min_gap_mm for pair in made.validation.pairs if pair.min_gap_mm is not None]
    crossing = sum(pair.intersecting_pairs for pair in made.validation.pairs)
    crossing += sum(mesh.self_intersecting_pairs for mesh in made.validation.meshes.values())
    layers = ", ".join(
        f"{name} {layer.target_mm:g} mm on {100 * layer.on_target_area:.2f} %"
        for name, layer in thickness_reports(made.layers, made.inputs.as_shells(())).items()
    )
    inner = len(made.tissues) - len(made.layers.surfaces())
    filled = (
        ""
        if made.volume is None
        else f" {len(made.volume.tetrahedra)} tetrahedra in {len(made.regions)} regions, one per tissue."
    )
    tissues = f" and {inner} inner tissue{'' if inner == 1 else 's'}" if inner else ""
    return (
        f"{len(made.layers.surfaces())} nested shells{tissues}, {crossing} intersecting faces, smallest gap {min(gaps):.3f} mm; "
        f"on target by area: {layers}.{filled}"
    )
