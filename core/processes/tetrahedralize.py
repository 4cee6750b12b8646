"""The process `tetrahedralize`: the space between surfaces filled, each tissue a region, proven and written for solvers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.errors import InputError
from core.package.tissue import FREE_SPACE, Tissue
from core.processes.loaded_surfaces import LoadedSurfaces, load_surfaces
from core.processes.outcome import Outcome
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.processes.tissue_filling import (
    draw_elements,
    fill_tissues,
    find_other_mesher,
    least_gap,
    mesher_version,
    region_reports,
    require_known_tissues,
    tetrahedra_methods,
    tetrahedra_references,
    tetrahedra_summary,
    write_volume,
)
from core.processes.validate import METHODS as VALIDATE_METHODS
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.figures.compose import draw_mesh_figures
from core.run import RunContext
from core.schema.finding import Severity
from core.schema.report import Report
from core.schema.tetrahedralize import TetrahedralizeInputs
from core.validation.validate import Validation


def run_tetrahedralize(
    inputs: TetrahedralizeInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path
) -> Outcome:
    """A volume mesh of all surfaces.

    Raises: InputError `tetrahedra.surfaces_unfit` with the report of what is wrong, `tetrahedra.no_room`, `tetrahedra.refused`,
    `tetrahedra.unknown_tissue`, `package.*`; StateError `tetrahedra.no_mesher`; InternalError `tetrahedra.not_proven`.
    """
    source = load_surfaces(inputs, meshes, run.stage("load", 0.0, 0.03))
    require_known_tissues(inputs, list(source.meshes))
    before = validate_once(source.meshes, inputs.min_gap_mm, run.stage("look at the surfaces", 0.03, 0.15))
    asked = inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"})
    _require_fit(inputs, source, before)
    stage = run.stage("fill", 0.15, 0.85)
    decisive = (source.meshes, dict(before.nesting), asked, least_gap(inputs.min_gap_mm, before))
    volume = stage.checkpoint("tetrahedra", lambda: fill_tissues(source.meshes, before, inputs, inputs.min_gap_mm), *decisive)
    stage.advance(1.0, f"{len(volume.tetrahedra)} tetrahedra")
    write = run.stage("write", 0.85, 0.9)
    tissues = _tissues(source, before)
    files = write_volume(tissues, volume, out_dir)
    write.advance(1.0)
    run.stage("figures", 0.9, 1.0)
    regions = region_reports(volume, tissues)
    report = _surface_report(inputs, source, before, tetrahedra_summary(volume, regions)).model_copy(
        update={
            "regions": regions,
            "findings": (*before.findings, *find_other_mesher(inputs, volume)),
            "methods": tetrahedra_methods(inputs, volume.mesher),
            "references": tetrahedra_references(volume.mesher),
            "software": {**software_versions(), **mesher_version(volume.mesher)},
        }
    )
    figures = (
        *draw_mesh_figures(source.meshes, pairs=before.pairs, findings=before.findings),
        draw_elements(volume, tissues),
    )
    return Outcome(report, figures, files, source.meshes)


def _require_fit(inputs: TetrahedralizeInputs, source: LoadedSurfaces, before: Validation) -> None:
    """A set that cannot be filled is refused before TetGen sees it, with the faces at fault."""
    errors = [finding for finding in before.findings if finding.severity is Severity.ERROR]
    if not errors:
        return
    words = "; ".join(finding.message for finding in errors[:3])
    message = f"these surfaces do not bound tissues: {words}"
    report = _surface_report(inputs, source, before, f"Not filled: {words}.")
    raise InputError("tetrahedra.surfaces_unfit", message, findings=tuple(errors), report=report)


def _tissues(source: LoadedSurfaces, before: Validation) -> tuple[Tissue, ...]:
    return tuple(
        Tissue(name, mesh, None, source.conductivities_s_per_m[name], before.nesting[name] or FREE_SPACE)
        for name, mesh in source.meshes.items()
    )


def _surface_report(inputs: TetrahedralizeInputs, source: LoadedSurfaces, before: Validation, summary: str) -> Report:
    """Of the surfaces alone."""
    return Report(
        process="tetrahedralize",
        verdict=before.verdict,
        summary=summary,
        meshes=before.meshes,
        pairs=before.pairs,
        nesting=before.nesting,
        findings=before.findings,
        changes=source.changes,
        methods=VALIDATE_METHODS,
        references=VALIDATE_REFERENCES,
        parameters={**inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"}), **source.sources},
        software=software_versions(),
    )
