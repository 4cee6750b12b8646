"""The process `tetrahedralize`: the space between surfaces filled, each tissue a region, proven and written for solvers."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError
from core.package.conductivity import conductivity_of
from core.package.region_tag import region_tags
from core.package.tissue import FREE_SPACE, Tissue
from core.package.volume_files import write_msh, write_vtu
from core.processes.loaded_surfaces import LoadedSurfaces, load_surfaces
from core.processes.outcome import Outcome, OutputFile
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.reports.figures.compose import draw_mesh_figures
from core.reports.figures.element_histogram import draw_element_histogram
from core.reports.palette import tissue_colours
from core.run import RunContext
from core.schema.finding import Severity
from core.schema.report import RegionReport, Report
from core.schema.tetrahedralize import TetrahedralizeInputs
from core.tetrahedra.element_quality import quality, smallest_dihedral_deg, volumes
from core.tetrahedra.fill import fill
from core.tetrahedra.volume_mesh import VolumeMesh
from core.validation.validate import Validation

METHODS = (
    "The space between the surfaces was filled with tetrahedra by TetGen [3]{shape}, without a vertex added on a surface. It was "
    "checked that every face of every surface is a face of tetrahedra with its tissue inside and the tissue around it outside, "
    "that tetrahedra meet face to face, that none is flat or inverted, and that those of each tissue add up to the volume "
    "between its surface and those inside."
)
REFERENCES = (
    *VALIDATE_REFERENCES,
    "[3] H. Si, TetGen, a Delaunay-based quality tetrahedral mesh generator, ACM Transactions on Mathematical Software 41, 2015, "
    "doi:10.1145/2629697",
)


def run_tetrahedralize(
    inputs: TetrahedralizeInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path
) -> Outcome:
    """A volume mesh of all surfaces.

    Raises: InputError `tetrahedra.surfaces_unfit` with the report of what is wrong, `tetrahedra.no_room`, `tetrahedra.refused`,
    `tetrahedra.unknown_tissue`, `package.*`; InternalError `tetrahedra.not_proven`.
    """
    source = load_surfaces(inputs, meshes, run.stage("load", 0.0, 0.03))
    _require_known(inputs, source)
    before = validate_once(source.meshes, inputs.min_gap_mm, run.stage("look at the surfaces", 0.03, 0.15))
    asked = inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"})
    _require_fit(inputs, source, before)
    stage = run.stage("fill", 0.15, 0.85)
    decisive = (source.meshes, dict(before.nesting), asked, _least_gap(inputs, before))
    volume = stage.checkpoint("tetrahedra", lambda: _fill(inputs, source, before), *decisive)
    stage.advance(1.0, f"{len(volume.tetrahedra)} tetrahedra")
    write = run.stage("write", 0.85, 0.9)
    tissues = _tissues(source, before)
    write_msh(out_dir / "volume.msh", tissues, volume)
    write_vtu(out_dir / "volume.vtu", tissues, volume)
    write.advance(1.0)
    run.stage("figures", 0.9, 1.0)
    shapes = quality(volume.corners())
    named = {tissue.name: shapes[volume.region == number] for number, tissue in enumerate(tissues)}
    report = _report(inputs, source, before, volume, tissues)
    figures = (
        *draw_mesh_figures(source.meshes, pairs=before.pairs, findings=before.findings),
        draw_element_histogram(named, tissue_colours(list(named))),
    )
    files = (
        OutputFile("msh", Path("volume.msh"), "application/x-gmsh", "volume.msh"),
        OutputFile("vtu", Path("volume.vtu"), "application/x-vtu", "volume.vtu"),
    )
    return Outcome(report, figures, files)


def _require_known(inputs: TetrahedralizeInputs, source: LoadedSurfaces) -> None:
    unknown = sorted(set(inputs.max_volume_mm3) - set(source.meshes))
    if unknown:
        raise InputError(
            "tetrahedra.unknown_tissue",
            f"max_volume_mm3 names {', '.join(unknown)}, the surfaces are {', '.join(source.meshes)}",
        )


def _require_fit(inputs: TetrahedralizeInputs, source: LoadedSurfaces, before: Validation) -> None:
    """A set that cannot be filled is refused before TetGen sees it, with the faces at fault."""
    errors = [finding for finding in before.findings if finding.severity is Severity.ERROR]
    if not errors:
        return
    words = "; ".join(finding.message for finding in errors[:3])
    message = f"these surfaces do not bound tissues: {words}"
    report = _surface_report(inputs, source, before, f"Not filled: {words}.")
    raise InputError("tetrahedra.surfaces_unfit", message, findings=tuple(errors), report=report)


def _least_gap(inputs: TetrahedralizeInputs, before: Validation) -> float:
    return min([inputs.min_gap_mm, *(pair.min_gap_mm for pair in before.pairs if pair.min_gap_mm)])


def _fill(inputs: TetrahedralizeInputs, source: LoadedSurfaces, before: Validation) -> VolumeMesh:
    return fill(
        source.meshes,
        before.nesting,
        gap_mm=_least_gap(inputs, before),
        radius_edge=inputs.radius_edge,
        largest_mm3=inputs.max_volume_mm3,
    )


def _tissues(source: LoadedSurfaces, before: Validation) -> tuple[Tissue, ...]:
    known = {name: tissue.conductivity_s_per_m for name, tissue in source.tissues.items()}
    return tuple(
        Tissue(name, mesh, None, known.get(name, conductivity_of(name)), before.nesting[name] or FREE_SPACE)
        for name, mesh in source.meshes.items()
    )


def _report(
    inputs: TetrahedralizeInputs,
    source: LoadedSurfaces,
    before: Validation,
    volume: VolumeMesh,
    tissues: tuple[Tissue, ...],
) -> Report:
    tags = region_tags(tissues)
    regions = {
        tissue.name: _region_report(volume.corners()[volume.region == number], tags[tissue.name])
        for number, tissue in enumerate(tissues)
    }
    worst = min(regions, key=lambda name: regions[name].quality_minimum)
    summary = (
        f"{len(volume.tetrahedra)} tetrahedra in {len(regions)} tissue{'s' if len(regions) > 1 else ''}, none inverted, volumes "
        f"proven; smallest quality {regions[worst].quality_minimum:.2g} (in {worst})."
    )
    report = _surface_report(inputs, source, before, summary)
    return report.model_copy(update={"regions": regions})


def _region_report(corners: np.ndarray[Any, np.dtype[np.float64]], tag: int) -> RegionReport:
    shapes = quality(corners)
    return RegionReport(
        region_tag=tag,
        tetrahedra=len(corners),
        volume_mm3=float(volumes(corners).sum()),
        quality_minimum=float(shapes.min()),
        quality_percentile_1=float(np.percentile(shapes, 1)),
        quality_median=float(np.median(shapes)),
        smallest_dihedral_deg=float(smallest_dihedral_deg(corners).min()),
    )


def _surface_report(inputs: TetrahedralizeInputs, source: LoadedSurfaces, before: Validation, summary: str) -> Report:
    ratio = f" with a ratio of circumradius to shortest edge of at most {inputs.radius_edge or 0:g} where the surfaces allow it"
    shape = "" if inputs.radius_edge is None else ratio
    return Report(
        process="tetrahedralize",
        verdict=before.verdict,
        summary=summary,
        meshes=before.meshes,
        pairs=before.pairs,
        nesting=before.nesting,
        findings=before.findings,
        changes=source.changes,
        methods=METHODS.format(shape=shape),
        references=REFERENCES,
        parameters={**inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package"}), **source.sources},
        software={**software_versions(), "tetgen": version("tetgen")},
    )
