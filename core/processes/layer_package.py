"""From a skin and what is wanted below it to the package: layers, proof on the delivered files, report, figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InternalError
from core.mesh import Mesh
from core.package.build import build_package
from core.package.conductivity import conductivities
from core.package.tissue import FREE_SPACE, Tissue
from core.processes.made_layers import MadeLayers, layer_notes, make_layers, marked_areas, thickness_reports
from core.processes.outcome import Outcome, OutputFile
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.processes.written_surfaces import require_unchanged, write_and_read_back
from core.reports.figures.compose import draw_shell_figures
from core.reports.figures.figure import Figure
from core.run import RunContext
from core.schema.finding import Finding, Severity
from core.schema.report import Report, ThicknessReport
from core.schema.shells import ShellsInputs
from core.shells.nested_shells import Shell
from core.validation.validate import Validation


@dataclass(frozen=True, eq=False, slots=True)
class LayerJob:
    """What differs between the processes that end in layers.

    skin: fit, coordinates exact in float32. arrays: name -> (V,) mm, depths that layers may refer to. describe: findings of
    the process' own about the shells made. draw: figures of its own about all surfaces by name, before the others.
    """

    process: str
    skin: Mesh
    inputs: ShellsInputs
    methods: str
    references: tuple[str, ...]
    parameters: Mapping[str, Any]
    changes: tuple[dict[str, Any], ...] = ()
    arrays: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    describe: Callable[[tuple[Shell, ...]], tuple[Finding, ...]] = lambda _shells: ()
    draw: Callable[[Mapping[str, Mesh]], tuple[Figure, ...]] = lambda _surfaces: ()


def deliver_layers(job: LayerJob, run: RunContext, out_dir: Path) -> Outcome:
    """Layers, proof on the files, report and package.

    Raises: InputError `layer.*`, `region.*`, `skin.too_thin`, `shells.no_room`; InternalError `skin.shift_not_proven`,
    `shells.not_proven` with a report.
    """
    inputs = job.inputs
    made = make_layers(job.skin, inputs, job.arrays, run.stage("layers", 0.0, 0.57))
    run.stage("write and read back", 0.57, 0.6)
    surfaces = made.surfaces()
    delivered = write_and_read_back(surfaces, out_dir)
    validation = validate_once(delivered, inputs.min_gap_mm, run.stage("prove", 0.6, 0.77))
    report = _report(job, made, validation)
    _require_proven(report, list(surfaces))

    run.stage("figures", 0.77, 0.94)
    tissues = _tissues(made, report, surfaces, inputs.conductivities_s_per_m)
    depths = {shell.name: shell.depth_mm for shell in made.shells}
    drawn = draw_shell_figures(tissues, depths, pairs=report.pairs, findings=report.findings, areas=marked_areas(made))
    figures = (*job.draw(surfaces), *drawn)
    run.stage("package", 0.94, 1.0)
    package = out_dir / "package.zip"
    packed = build_package(package, tissues, report, figures, depths)
    require_unchanged(package, delivered)
    return Outcome(
        packed,
        figures,
        (
            OutputFile("package", Path(package.name), "application/zip", package.name),
            *(OutputFile(name, Path(f"{name}.stl"), "model/stl", f"{name}.stl") for name in surfaces),
        ),
        surfaces,
        depths,
    )


def _report(job: LayerJob, made: MadeLayers, validation: Validation) -> Report:
    thickness = thickness_reports(made, job.inputs)
    changes, notes = layer_notes(made, job.inputs)
    return Report(
        process=job.process,
        verdict=validation.verdict,
        summary=_summary(validation, thickness),
        meshes=validation.meshes,
        pairs=validation.pairs,
        thickness=thickness,
        nesting=validation.nesting,
        findings=(*job.describe(made.shells), *validation.findings, *notes),
        changes=(*job.changes, *changes),
        methods=job.methods,
        references=job.references,
        parameters=dict(job.parameters),
        software=software_versions(),
    )


def _summary(validation: Validation, thickness: Mapping[str, ThicknessReport]) -> str:
    layers = ", ".join(
        f"{name} {layer.target_mm:g} mm on {100 * layer.on_target_area:.2f} %" for name, layer in thickness.items()
    )
    gaps = [pair.min_gap_mm for pair in validation.pairs if pair.min_gap_mm is not None]
    crossing = sum(pair.intersecting_pairs for pair in validation.pairs)
    crossing += sum(mesh.self_intersecting_pairs for mesh in validation.meshes.values())
    return (
        f"{len(validation.meshes)} nested shells, {crossing} intersecting faces, smallest gap {min(gaps):.3f} mm; "
        f"on target by area: {layers}."
    )


def _require_proven(report: Report, outermost_first: list[str]) -> None:
    """Never hand out layers that break the promise: that would be our bug, and is said with all that is known."""
    chain = dict(zip(outermost_first, (None, *outermost_first), strict=False))
    if report.verdict == "simulation_ready" and report.nesting == chain:
        return
    errors = [finding for finding in report.findings if finding.severity is Severity.ERROR]
    words = "; ".join(finding.message for finding in errors[:3]) or f"the shells nest as {report.nesting}, not {chain}"
    raise InternalError("shells.not_proven", f"the shells made do not pass the proof: {words}", report=report, findings=())


def _tissues(made: MadeLayers, report: Report, surfaces: Mapping[str, Mesh], own: Mapping[str, float]) -> tuple[Tissue, ...]:
    depths = {name: layer.target_mm for name, layer in report.thickness.items()}
    sides = {shell.name: shell.side for shell in made.shells}
    values = conductivities(surfaces, own)
    enclosing = dict(zip(surfaces, (FREE_SPACE, *surfaces), strict=False))
    return tuple(
        Tissue(name, mesh, depths.get(name), values[name], enclosing[name], sides.get(name)) for name, mesh in surfaces.items()
    )
