"""The process `segment`: labels of voxels to closed surfaces that keep apart, proven on the files that are delivered."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.errors import InternalError
from core.io.canonical_volume import load_volume
from core.label_volume import LabelVolume
from core.mesh import Mesh
from core.package.build import build_package
from core.package.conductivity import conductivities
from core.package.tissue import FREE_SPACE, Tissue
from core.processes.outcome import Outcome, OutputFile
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.processes.surface_package import in_nesting_order
from core.processes.validate import REFERENCES as VALIDATE_REFERENCES
from core.processes.written_surfaces import require_unchanged, write_and_read_back
from core.reports.figures.compose import draw_mesh_figures
from core.run import RunContext
from core.schema.finding import Finding, Severity
from core.schema.report import Report
from core.schema.segment import SegmentInputs
from core.segmentation.account import describe, find_findings
from core.segmentation.segment import Segmented, segment
from core.validation.validate import Validation

METHODS = (
    "The border of each label was taken half-way between voxel centres inside and outside, where the signed distance to the "
    "border, freed of the steps of voxels, is zero [3, 4]; between tetrahedra of the voxel grid it is a closed manifold [5]. "
    "It was shifted so that every surface encloses the volume of its voxels, and where labels meet, both surfaces gave way by "
    "half of {gap:g} mm. Triangles were thinned out [6] and smoothed without shrinkage [7], no vertex by more than 0.3 of a "
    "voxel, while no surface crossed itself or came nearer to another. Coordinates were rounded to single precision, written to "
    "binary STL, read back, and checked there with exact predicates [1]."
)
REFERENCES = (
    *VALIDATE_REFERENCES,
    "[3] S. P. Raya, J. K. Udupa, Shape-based interpolation of multidimensional objects, IEEE Transactions on Medical Imaging 9, "
    "1990, doi:10.1109/42.52980",
    "[4] R. T. Whitaker, Reducing aliasing artifacts in iso-surfaces of binary volumes, IEEE Symposium on Volume Visualization, "
    "2000, doi:10.1145/353888.353893",
    "[5] J. Bloomenthal, Polygonization of implicit surfaces, Computer Aided Geometric Design 5, 1988, "
    "doi:10.1016/0167-8396(88)90013-1",
    "[6] M. Garland, P. S. Heckbert, Surface simplification using quadric error metrics, SIGGRAPH 1997, "
    "doi:10.1145/258734.258849",
    "[7] G. Taubin, A signal processing approach to fair surface design, SIGGRAPH 1995, doi:10.1145/218380.218473",
)


def run_segment(inputs: SegmentInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """Surfaces by name, and their package.

    Raises: InputError `segment.*`; InternalError `reference.unresolved`, `canonical.corrupt`, `package.differs`, and
    `segment.not_proven` with a report.
    """
    load = run.stage("load", 0.0, 0.03)
    volume, source = _load(inputs.volume.href, meshes)
    sides = " x ".join(str(side) for side in volume.labels.shape)
    load.advance(1.0, f"{sides} voxels, {len(volume.counts())} labels")
    step = run.stage("segment", 0.03, 0.6)
    asked = inputs.model_dump(mode="json", exclude={"volume"})
    made = step.checkpoint(
        "segment", lambda: segment(volume, inputs, inputs.min_gap_mm, step), volume.labels, volume.affine, asked
    )
    values = conductivities(made, inputs.conductivities_s_per_m)
    delivered = write_and_read_back({name: each.mesh for name, each in made.items()}, out_dir)
    after = validate_once(delivered, inputs.min_gap_mm, run.stage("prove", 0.6, 0.8))
    report = _report(inputs, made, after, {**asked, "volume": source})
    _require_proven(report, after)
    run.stage("figures", 0.8, 0.95)
    shown = {name: delivered[name] for name in report.meshes}
    figures = draw_mesh_figures(shown, pairs=report.pairs, findings=report.findings)
    run.stage("package", 0.95, 1.0)
    package = out_dir / "package.zip"
    packed = build_package(package, _tissues(report, shown, values), report, figures)
    require_unchanged(package, delivered)
    files = tuple(OutputFile(name, Path(f"{name}.stl"), "model/stl", f"{name}.stl") for name in delivered)
    zipped = OutputFile("package", Path(package.name), "application/zip", package.name)
    return Outcome(packed, figures, (zipped, *files), shown)


def _load(href: str, entries: Mapping[str, Mapping[str, Any]]) -> tuple[LabelVolume, dict[str, str]]:
    entry = entries.get(href)
    if entry is None:
        raise InternalError("reference.unresolved", f"{href} was accepted but not resolved", href=href)
    return load_volume(Path(entry["path"])), {"name": entry["name"], "sha256": entry["sha256"]}


def _report(inputs: SegmentInputs, made: Mapping[str, Segmented], after: Validation, parameters: dict[str, Any]) -> Report:
    return Report(
        process="segment",
        verdict=after.verdict,
        summary=_summary(made, after),
        meshes={name: after.meshes[name] for name in in_nesting_order(after.nesting)},
        pairs=after.pairs,
        nesting=after.nesting,
        findings=(*after.findings, *find_findings(made, after.meshes)),
        changes=describe(made, after.meshes),
        methods=METHODS.format(gap=inputs.min_gap_mm),
        references=REFERENCES,
        parameters=parameters,
        software=software_versions(),
    )


def _summary(made: Mapping[str, Segmented], after: Validation) -> str:
    rows = [
        f"{name}: {mesh.faces} faces, volume {(mesh.volume_mm3 or 0.0) / made[name].voxels_mm3 - 1.0:+.2%} of its voxels"
        for name, mesh in after.meshes.items()
    ]
    gaps = [pair.min_gap_mm for pair in after.pairs if pair.min_gap_mm is not None]
    apart = f" The smallest gap is {min(gaps):.3f} mm." if gaps else ""
    crossing = sum(mesh.self_intersecting_pairs for mesh in after.meshes.values())
    crossing += sum(pair.intersecting_pairs for pair in after.pairs)
    return f"{'; '.join(rows)}. {crossing} intersecting pairs of faces.{apart}"


def _require_proven(report: Report, after: Validation) -> None:
    broken: list[Finding] = [finding for finding in after.findings if finding.severity is Severity.ERROR]
    if broken:
        words = "; ".join(finding.message for finding in broken[:3])
        raise InternalError("segment.not_proven", f"the surfaces made do not pass the proof: {words}", report=report)


def _tissues(report: Report, surfaces: Mapping[str, Mesh], values: Mapping[str, float]) -> tuple[Tissue, ...]:
    return tuple(Tissue(name, mesh, None, values[name], report.nesting[name] or FREE_SPACE) for name, mesh in surfaces.items())
