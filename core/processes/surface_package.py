"""From surfaces made to what is delivered: files, proof on the files read back, report with before and after, package."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from core.errors import InternalError
from core.geometry.deviation import Deviation, measure_deviation
from core.mesh import Mesh
from core.package.build import build_package
from core.package.tissue import FREE_SPACE, Tissue
from core.processes.loaded_surfaces import LoadedSurfaces
from core.processes.outcome import Outcome, OutputFile, with_originals
from core.processes.proof import validate_once
from core.processes.software import software_versions
from core.processes.written_surfaces import require_unchanged, write_and_read_back
from core.reports.figures.compare import draw_comparison
from core.reports.figures.figure import Figure
from core.run import RunContext
from core.schema.finding import Finding
from core.schema.report import Report
from core.validation.comparison import compare_with_original
from core.validation.validate import Validation

PROOF = (
    "Coordinates were rounded to single precision, written to binary STL, read back, and checked there with exact "
    "predicates [1]. Deviation is the distance between the surfaces in both ways, at all vertices and in the middles of faces."
)
Proof = Callable[[Validation, Mapping[str, Deviation]], list[str]]


@dataclass(frozen=True, eq=False, slots=True)
class SurfaceJob:
    """What differs between the processes that turn surfaces into surfaces.

    source: what came, checked as `before`. made: the same names, exact in float32. find_broken: what a result, as validated
    and compared, breaks of the promise, in words; empty if it keeps it. not_proven: the code if it breaks any. draw: figures of
    its own, after the others.
    """

    process: str
    not_proven: str
    source: LoadedSurfaces
    before: Validation
    made: Mapping[str, Mesh]
    min_gap_mm: float
    summary: Callable[[Report], str]
    find_broken: Proof
    methods: str
    references: tuple[str, ...]
    parameters: Mapping[str, Any]
    changes: tuple[dict[str, Any], ...] = ()
    findings: tuple[Finding, ...] = ()
    draw: Callable[[Report], tuple[Figure, ...]] = field(default=lambda _report: ())


def deliver_surfaces(job: SurfaceJob, run: RunContext, out_dir: Path) -> Outcome:
    """Files, proof, report; a package if several surfaces came or a package.

    Raises: InternalError `package.differs`, and `job.not_proven` with a report.
    """
    run.stage("write and read back", 0.0, 0.06)
    delivered = write_and_read_back(job.made, out_dir)
    after = validate_once(delivered, job.min_gap_mm, run.stage("prove", 0.06, 0.35))
    compare = run.stage("compare", 0.35, 0.5)
    deviations = {name: measure_deviation(job.source.meshes[name], mesh) for name, mesh in delivered.items()}
    report = _report(job, after, delivered, deviations)
    compare.advance(1.0, f"deviation {max(each.maximum_mm for each in deviations.values()):.4g} mm")
    _require_proven(job, report, after, deviations)
    run.stage("figures", 0.5, 0.92)
    figures = (*draw_comparison(job.source.meshes, deviations, report), *job.draw(report))
    files = tuple(OutputFile(name, Path(f"{name}.stl"), "model/stl", f"{name}.stl") for name in delivered)
    shown = with_originals({name: delivered[name] for name in report.meshes}, job.source.meshes)
    if not job.source.together:
        return Outcome(report, figures, files, shown)
    run.stage("package", 0.92, 1.0)
    package = out_dir / "package.zip"
    packed = build_package(package, _tissues(job, report), report, figures)
    require_unchanged(package, delivered)
    files = (OutputFile("package", Path(package.name), "application/zip", package.name), *files)
    return Outcome(packed, figures, files, shown)


def _report(job: SurfaceJob, after: Validation, delivered: Mapping[str, Mesh], deviations: Mapping[str, Deviation]) -> Report:
    order = in_nesting_order(after.nesting) if job.source.together else tuple(delivered)
    report = Report(
        process=job.process,
        verdict=after.verdict,
        summary="",
        meshes={name: after.meshes[name] for name in order},
        pairs=after.pairs,
        comparisons={
            name: compare_with_original(
                job.source.meshes[name], job.before.meshes[name], delivered[name], after.meshes[name], deviations[name]
            )
            for name in order
        },
        nesting=after.nesting,
        findings=(*after.findings, *job.findings),
        changes=(*job.source.changes, *job.changes),
        methods=job.methods,
        references=job.references,
        parameters={**job.parameters, **job.source.sources},
        software=software_versions(),
    )
    return report.model_copy(update={"summary": job.summary(report)})


def in_nesting_order(nesting: Mapping[str, str | None]) -> tuple[str, ...]:
    """Every name after the one that encloses it, otherwise in their order."""
    order: list[str] = []

    def add(name: str) -> None:
        holder = nesting[name]
        if holder is not None and holder not in order:
            add(holder)
        if name not in order:
            order.append(name)

    for name in nesting:
        add(name)
    return tuple(order)


def _require_proven(job: SurfaceJob, report: Report, after: Validation, deviations: Mapping[str, Deviation]) -> None:
    """Never hand out surfaces that break the promise: that would be our bug, and is said with all that is known."""
    broken = job.find_broken(after, deviations)
    if broken:
        words = "; ".join(broken[:3])
        raise InternalError(job.not_proven, f"the surfaces made do not pass the proof: {words}", report=report, findings=())


def _tissues(job: SurfaceJob, report: Report) -> tuple[Tissue, ...]:
    """With depths and sides as the package that came has them."""
    tissues = []
    for name in report.meshes:
        known = job.source.tissues.get(name)
        enclosing = report.nesting[name] or FREE_SPACE
        depth_mm, side = (None, None) if known is None else (known.depth_mm, known.side)
        conductivity = job.source.conductivities_s_per_m[name]
        tissues.append(Tissue(name, job.made[name], depth_mm, conductivity, enclosing, side))
    return tuple(tissues)
