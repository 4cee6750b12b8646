"""The process `fields`: a solver's field brought onto surfaces, with numbers, pictures and files; the coil drawn beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from core.coil import Coil
from core.errors import InputError, InternalError
from core.field_source import FieldTable
from core.fields.asked_columns import FieldPoints, points_of
from core.fields.coil_distance import measure_coil
from core.fields.field_reader import FieldReader
from core.fields.mapped import MappedField
from core.fields.no_overlap import no_overlap
from core.fields.statistics import measure_field
from core.io.canonical_coil import load_coil
from core.io.canonical_field import load_field
from core.mesh import Mesh
from core.package.archive import write_archive
from core.package.conductivity import conductivity_of
from core.package.field_files import write_mat, write_msh, write_statistics, write_vtu
from core.package.field_readme import field_readme
from core.package.tissue import FREE_SPACE, Tissue
from core.processes.loaded_surfaces import load_surfaces
from core.processes.outcome import Outcome, OutputFile
from core.processes.software import software_versions
from core.reports.figures.field_map import draw_field_map
from core.reports.figures.figure import Figure
from core.reports.scene.scene import Painted
from core.run import RunContext
from core.schema.fields import FieldsInputs
from core.schema.finding import MAX_PLACES, Finding, Place, Severity
from core.schema.report import CoilReport, FieldReport, Report

ZIP, MSH, STATISTICS = "fields.zip", "fields.msh", "statistics.csv"
PAINTED = Painted("magnitude of the field, grey where there is none", "V/m")
METHODS = (
    "The field of a solver was brought onto the surfaces: the value of a triangle is the mean over it ({ways}). Triangles "
    "farther than {limit:g} mm from the field were given no value. Means and percentiles are weighted by area; normal and "
    "tangential parts refer to the plane of each triangle."
)
COIL_METHODS = (
    " The coil was placed by the matrix given; its distance is that of its nearest dipole or piece of wire to {surface}."
)


@dataclass(frozen=True, eq=False, slots=True)
class _Loaded:
    """What was read: surfaces by name, who answers for the field, the coil where it stands, and what went in."""

    surfaces: Mapping[str, Mesh]
    reader: FieldReader
    coil: Coil | None
    sources: Mapping[str, Any]
    findings: tuple[Finding, ...]
    changes: tuple[dict[str, Any], ...]


def run_fields(inputs: FieldsInputs, meshes: Mapping[str, Mapping[str, Any]], run: RunContext, out_dir: Path) -> Outcome:
    """The field on every surface.

    Raises: InputError `fields.*`, `package.*`, `reference.not_a_mesh`; InternalError `reference.unresolved`, `canonical.corrupt`.
    """
    loaded = _load(inputs, meshes, run)
    step = run.stage("map", 0.25, 0.6)
    mapped: dict[str, MappedField] = {}
    for number, (name, surface) in enumerate(loaded.surfaces.items()):
        mapped[name] = loaded.reader.map_onto(surface)
        step.advance((number + 1) / len(loaded.surfaces), f"{name}: {int(mapped[name].too_far.sum())} triangles without a value")
    if all(each.too_far.all() for each in mapped.values()):
        raise no_overlap(loaded.surfaces.values(), loaded.reader.places(), inputs.max_distance_mm)
    fields = {name: measure_field(surface, mapped[name]) for name, surface in loaded.surfaces.items()}
    about = max(loaded.surfaces, key=lambda name: float(np.prod(loaded.surfaces[name].extents_mm())))
    coil = None if loaded.coil is None else measure_coil(loaded.coil, about, loaded.surfaces[about])
    run.stage("figures", 0.6, 0.85)
    figures = tuple(
        draw_field_map(name, surface, mapped[name].magnitude, loaded.coil, loaded.surfaces[about])
        for name, surface in loaded.surfaces.items()
    )
    report = _report(inputs, loaded, mapped, fields, coil)
    run.stage("write", 0.85, 1.0)
    files = _write(out_dir, loaded, mapped, report, figures)
    painted = {name: each.magnitude for name, each in mapped.items()}
    return Outcome(report, figures, files, loaded.surfaces, painted, painted=PAINTED)


def _load(inputs: FieldsInputs, entries: Mapping[str, Mapping[str, Any]], run: RunContext) -> _Loaded:
    source = load_surfaces(inputs, entries, run.stage("load", 0.0, 0.1))
    unknown = sorted(set(inputs.only) - set(source.meshes))
    if unknown:
        raise InputError(
            "fields.surface_unknown", f"there is no surface {', '.join(unknown)}: there are {', '.join(source.meshes)}"
        )
    surfaces = {name: mesh for name, mesh in source.meshes.items() if not inputs.only or name in inputs.only}
    step = run.stage("load the field", 0.1, 0.25)
    entry = _entry(inputs.field.href, entries)
    sources: dict[str, Any] = {**source.sources, "field": {"name": entry["name"], "sha256": entry["sha256"]}}
    read = load_field(Path(entry["path"]))
    findings: tuple[Finding, ...] = ()
    if isinstance(read, FieldTable):
        points = points_of(read, inputs.columns, inputs.not_finite)
        reader, findings = FieldReader(points, inputs), _of_rows(points)
        step.advance(1.0, f"{len(points.points)} points")
    else:
        reader = FieldReader(read, inputs)
        step.advance(1.0, f"{len(read.nodes)} nodes, {len(read.triangles)} triangles, {len(read.tetrahedra)} tetrahedra")
    coil = None
    if inputs.coil is not None:
        entry = _entry(inputs.coil.file.href, entries)
        sources["coil_file"] = {"name": entry["name"], "sha256": entry["sha256"]}
        coil = load_coil(Path(entry["path"])).placed(np.array(inputs.coil.placement))
    return _Loaded(surfaces, reader, coil, sources, findings, source.changes)


def _entry(href: str, entries: Mapping[str, Mapping[str, Any]]) -> Mapping[str, Any]:
    if href not in entries:
        raise InternalError("reference.unresolved", f"{href} was accepted but not resolved", href=href)
    return entries[href]


def _of_rows(points: FieldPoints) -> tuple[Finding, ...]:
    findings = []
    if points.left_out:
        message = f"{points.left_out} of {points.rows} rows were left out for NaN or infinite numbers"
        findings.append(Finding(code="fields.rows_left_out", severity=Severity.WARNING, message=message, count=points.left_out))
    if points.merged:
        message = f"{points.merged} rows are at places of others; the mean at each place was taken"
        findings.append(Finding(code="fields.rows_merged", severity=Severity.INFO, message=message, count=points.merged))
    return tuple(findings)


def _report(
    inputs: FieldsInputs,
    loaded: _Loaded,
    mapped: Mapping[str, MappedField],
    fields: Mapping[str, FieldReport],
    coil: CoilReport | None,
) -> Report:
    far = _too_far(loaded.surfaces, mapped, inputs.max_distance_mm)
    ways = "; ".join(f"{name}: {each.method}" for name, each in mapped.items())
    methods = METHODS.format(ways=ways, limit=inputs.max_distance_mm)
    return Report(
        process="fields",
        verdict="not_ready" if far else "simulation_ready",
        summary=_summary(fields, coil),
        fields=dict(fields),
        coil=coil,
        findings=(*far, *loaded.findings, *_of_coil(coil)),
        changes=loaded.changes,
        methods=methods if coil is None else methods + COIL_METHODS.format(surface=coil.surface),
        parameters={
            **inputs.model_dump(mode="json", exclude={"mesh", "meshes", "package", "field", "coil"}),
            **({} if inputs.coil is None else {"coil_placement": inputs.coil.placement}),
            **loaded.sources,
        },
        software=software_versions(),
    )


def _summary(fields: Mapping[str, FieldReport], coil: CoilReport | None) -> str:
    told = []
    for name, each in fields.items():
        size = each.magnitude
        numbers = (
            "no value"
            if size is None
            else f"mean {size.mean:.4g}, 99 % below {size.percentile_99:.4g}, at most {size.maximum:.4g} V/m"
        )
        told.append(
            f"{name}: {numbers}" + (f" ({each.too_far} of {each.faces} triangles without a value)" if each.too_far else "")
        )
    beside = "" if coil is None else f" The coil is {coil.distance_mm:.2f} mm from {coil.surface}."
    return "; ".join(told) + "." + beside


def _too_far(surfaces: Mapping[str, Mesh], mapped: Mapping[str, MappedField], limit_mm: float) -> tuple[Finding, ...]:
    """An error for each surface that has triangles without a value, with the farthest of them."""
    findings = []
    for name, each in mapped.items():
        far = np.flatnonzero(each.too_far)
        if not len(far):
            continue
        farthest = far[np.argsort(-each.distance_mm[far], kind="stable")][:MAX_PLACES]
        middles = surfaces[name].triangles()[farthest].mean(axis=1)
        places = tuple(
            Place(mesh=name, point_mm=(float(x), float(y), float(z)), faces=(int(face),))
            for face, (x, y, z) in zip(farthest, middles, strict=True)
        )
        message = (
            f"{len(far)} of {len(each.distance_mm)} triangles of {name} are more than {limit_mm:g} mm from the field, up to "
            f"{each.distance_mm.max():.4g} mm: they have no value"
        )
        findings.append(Finding(code="fields.too_far", severity=Severity.ERROR, message=message, count=len(far), places=places))
    return tuple(findings)


def _of_coil(coil: CoilReport | None) -> tuple[Finding, ...]:
    if coil is None or not coil.inside:
        return ()
    message = (
        f"{coil.inside} of {coil.dipoles + coil.wire_pieces} dipoles and pieces of wire of the coil are inside of {coil.surface}"
    )
    return (Finding(code="coil.inside", severity=Severity.WARNING, message=message, count=coil.inside),)


def _write(
    out_dir: Path, loaded: _Loaded, mapped: Mapping[str, MappedField], report: Report, figures: tuple[Figure, ...]
) -> tuple[OutputFile, ...]:
    """One zip of everything, and beside it what one may want alone."""
    tissues = [Tissue(name, mesh, None, conductivity_of(name), FREE_SPACE) for name, mesh in loaded.surfaces.items()]
    write_msh(out_dir / MSH, tissues, mapped)
    write_statistics(out_dir / STATISTICS, report.fields)
    with TemporaryDirectory(dir=out_dir, prefix="fields-") as scratch:
        folder = Path(scratch)
        for part in ("mat", "vtu", "gmsh", "figures"):
            (folder / part).mkdir()
        for name, surface in loaded.surfaces.items():
            write_mat(folder / "mat" / f"{name}.mat", surface, mapped[name], loaded.coil)
            write_vtu(folder / "vtu" / f"{name}.vtu", surface, mapped[name])
        (folder / "gmsh" / MSH).write_bytes((out_dir / MSH).read_bytes())
        (folder / STATISTICS).write_bytes((out_dir / STATISTICS).read_bytes())
        (folder / "README.txt").write_text(field_readme(report), encoding="utf-8", newline="\n")
        (folder / "report.json").write_text(report.model_dump_json(indent=2) + "\n", encoding="utf-8", newline="\n")
        for figure in figures:
            (folder / "figures" / f"{figure.name}.png").write_bytes(figure.png)
        names = [path.relative_to(folder).as_posix() for path in sorted(folder.rglob("*")) if path.is_file()]
        write_archive(out_dir / ZIP, folder, names)
    return (
        OutputFile("fields", Path(ZIP), "application/zip", ZIP),
        OutputFile("msh", Path(MSH), "application/x-gmsh", MSH),
        OutputFile("statistics", Path(STATISTICS), "text/csv", STATISTICS),
    )
