"""From a skin and what is wanted below it to the package: layers, proof on the delivered files, report, figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InternalError
from core.io.registry import read_meshes, write_mesh
from core.mesh import Mesh
from core.package.build import build_package
from core.package.conductivity import conductivity_of
from core.package.read import read_shells
from core.package.tissue import FREE_SPACE, Tissue
from core.processes.outcome import Outcome, OutputFile
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.reports.figures.compose import draw_shell_figures
from core.reports.figures.figure import Figure
from core.reports.figures.marked_areas import LIMITED, MISSED, MOVED, MarkedArea
from core.run import RunContext
from core.schema.finding import Finding, Severity
from core.schema.report import Report, ThicknessReport
from core.schema.shells import ShellsInputs
from core.shells.moved_places import describe_move
from core.shells.nested_shells import Shell, create_shells
from core.shells.thickness import is_limited, is_on_target, measure_thickness
from core.shells.thin_places import check_depth
from core.shells.widen_skin import WidenedSkin, widen_skin
from core.validation.validate import Validation

SHIFT_SHARE = 0.03  # of the progress bar


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
    stage = run.stage("skin", 0.0, SHIFT_SHARE)
    widened = stage.checkpoint(
        "skin: widened",
        lambda: widen_skin(job.skin, inputs, job.arrays, stage),
        *(job.skin, inputs.model_dump(mode="json", exclude={"skin"}), job.arrays),
    )
    shells = create_shells(widened.mesh, inputs, run.stage("shells", SHIFT_SHARE, 0.57), job.arrays)
    run.stage("write and read back", 0.57, 0.6)
    surfaces = _outermost_first(widened.mesh, shells)
    delivered = _deliver(surfaces, out_dir)
    validation = validate_once(delivered, inputs.min_gap_mm, run.stage("prove", 0.6, 0.77))
    report = _report(job, widened, shells, validation)
    _require_proven(report, list(surfaces))

    run.stage("figures", 0.77, 0.94)
    tissues = _tissues(shells, report, surfaces)
    depths = {shell.name: shell.depth_mm for shell in shells}
    areas = _marked_areas(widened, shells)
    drawn = draw_shell_figures(tissues, depths, pairs=report.pairs, findings=report.findings, areas=areas)
    figures = (*job.draw(surfaces), *drawn)
    run.stage("package", 0.94, 1.0)
    package = out_dir / "package.zip"
    packed = build_package(package, tissues, report, figures)
    _require_unchanged(package, delivered)
    return Outcome(
        packed,
        figures,
        (
            OutputFile("package", Path(package.name), "application/zip", package.name),
            *(OutputFile(name, Path(f"{name}.stl"), "model/stl", f"{name}.stl") for name in surfaces),
        ),
    )


def _outermost_first(skin: Mesh, shells: tuple[Shell, ...]) -> dict[str, Mesh]:
    """All surfaces by name, as they nest: layers around the skin, the skin, layers below it."""
    around = {shell.name: shell.mesh for shell in shells if shell.side == "outside"}
    below = {shell.name: shell.mesh for shell in shells if shell.side == "inside"}
    return {**around, "skin": skin, **below}


def _deliver(surfaces: Mapping[str, Mesh], out_dir: Path) -> dict[str, Mesh]:
    """Write binary STL and read it back: what is proven is what the files hold."""
    delivered = {}
    for name, mesh in surfaces.items():
        path = out_dir / f"{name}.stl"
        write_mesh(mesh, path, "stl", name)
        delivered[name] = read_meshes(path, file_name=path.name, unit="mm").meshes[0].mesh
    return delivered


def _report(job: LayerJob, widened: WidenedSkin, shells: tuple[Shell, ...], validation: Validation) -> Report:
    thickness = {
        shell.name: measure_thickness(shell, layer.depth_mm, layer.depth_array)
        for shell, layer in zip(shells, job.inputs.layers, strict=True)
    }
    changes, moved = describe_move(widened, job.inputs.skin_shift_mm)
    return Report(
        process=job.process,
        verdict=validation.verdict,
        summary=_summary(validation, thickness),
        meshes=validation.meshes,
        pairs=validation.pairs,
        thickness=thickness,
        nesting=validation.nesting,
        findings=(
            *job.describe(shells),
            *moved,
            *validation.findings,
            *(finding for shell in shells for finding in check_depth(shell)),
        ),
        changes=(*job.changes, *changes),
        methods=job.methods,
        references=job.references,
        parameters=dict(job.parameters),
        software=software_versions(),
    )


def _marked_areas(widened: WidenedSkin, shells: tuple[Shell, ...]) -> dict[str, tuple[MarkedArea, ...]]:
    """What the figures paint on each surface: where the skin was moved, where a layer is off its depth and why."""
    moved = MarkedArea("skin.moved_outwards", "moved outwards", MOVED, widened.moved_mm > 0)
    areas: dict[str, tuple[MarkedArea, ...]] = {"skin": (moved,)}
    for shell in shells:
        limited, off = is_limited(shell), ~is_on_target(shell)
        areas[shell.name] = (
            MarkedArea("shells.depth_limited", "limited by anatomy", LIMITED, limited),
            MarkedArea("shells.depth_missed", "off its depth although there is room", MISSED, off & ~limited),
        )
    return areas


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


def _require_unchanged(package: Path, delivered: Mapping[str, Mesh]) -> None:
    """The package must hold the very files that were proven."""
    packed = read_shells(package)
    for name, mesh in delivered.items():
        if name not in packed or not np.array_equal(packed[name].triangles(), mesh.triangles()):
            raise InternalError("package.differs", f"the package does not hold the proven surface '{name}'", mesh=name)


def _tissues(shells: tuple[Shell, ...], report: Report, surfaces: Mapping[str, Mesh]) -> tuple[Tissue, ...]:
    depths = {name: layer.target_mm for name, layer in report.thickness.items()}
    sides = {shell.name: shell.side for shell in shells}
    enclosing = dict(zip(surfaces, (FREE_SPACE, *surfaces), strict=False))
    return tuple(
        Tissue(name, mesh, depths.get(name), conductivity_of(name), enclosing[name], sides.get(name))
        for name, mesh in surfaces.items()
    )
