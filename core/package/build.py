"""Build the package: one zip with every surface in every format, index files, manifest, README and report."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from core.io.registry import write_mesh
from core.package import glb, gmsh, nastran, openmeeg, smesh
from core.package.archive import write_archive
from core.package.bem_fmm import FOLDER as BEM_FMM
from core.package.bem_fmm import matlab_index, python_index
from core.package.conductivity import FREQUENCY, FREQUENCY_NOTE, look_up
from core.package.manifest import FILE_NAME, FileEntry, Manifest, TissueEntry, find_input_checksums
from core.package.merged_surfaces import merge
from core.package.readme import readme_text
from core.package.region_tag import region_tags
from core.package.requirements import require_packable
from core.package.tissue import Tissue
from core.reports.figures.figure import Figure
from core.reports.html import render_html
from core.reports.scene.mailable import mailable_faces
from core.reports.scene.scene import NO_DEPTHS, make_scene
from core.schema.report import Report

LONE_MM = 0.04  # how far below a surface without neighbours its region's point may be, times four


def build_package(
    out_path: Path,
    tissues: Sequence[Tissue],
    report: Report,
    figures: Sequence[Figure],
    depths_mm: Mapping[str, NDArray[np.float64]] = NO_DEPTHS,
    volume_msh: Path | None = None,
) -> Report:
    """Write the zip of spec section 3 and return its report, which names the checksums of the delivered STL files.

    Needs:    tissues in nesting order, float32-exact; input checksums as `sha256` in the parameters of the report; depths_mm
              as `make_scene` takes them; volume_msh: the tissues' tetrahedra as `write_msh` wrote them.
    Promises: same tissues, report and figures: the same bytes. The STL files are those of `write_mesh(mesh, path, "stl",
              name)`; MAT holds the same vertices bit for bit, in class double.
    Raises:   InternalError `package.name_refused`, `package.not_nested`, `package.not_rounded`.
    """
    require_packable(tissues)
    with TemporaryDirectory(dir=out_path.parent, prefix="package-") as scratch:
        folder = Path(scratch)
        for tissue in tissues:
            _write_surfaces(folder, tissue)
        checksums = {tissue.name: _sha256(folder / "stl" / f"{tissue.name}.stl") for tissue in tissues}
        packed = _with_checksums(report, checksums)
        scene = make_scene({tissue.name: tissue.mesh for tissue in tissues}, depths_mm, mailable_faces(figures))
        _write_text(folder / BEM_FMM / "tissue_index.txt", matlab_index(tissues))
        _write_text(folder / BEM_FMM / "tissue_index.yaml", python_index(tissues))
        _write_solver_files(folder, tissues, report)
        if volume_msh is not None:
            shutil.copyfile(volume_msh, folder / gmsh.VOLUME_FILE)
        _write_text(folder / "README.txt", readme_text(tissues, report, with_volume=volume_msh is not None))
        _write_text(folder / "report" / "report.json", packed.model_dump_json(indent=2) + "\n")
        _write_text(folder / "report" / "report.html", render_html(packed, figures, scene))
        for figure in figures:
            _parent_of(folder / "report" / "figures" / f"{figure.name}.png").write_bytes(figure.png)
        files = {path.relative_to(folder).as_posix(): _entry(path) for path in sorted(folder.rglob("*")) if path.is_file()}
        _write_text(folder / FILE_NAME, _manifest(tissues, packed, files).model_dump_json(indent=2) + "\n")
        write_archive(out_path, folder, [FILE_NAME, *files])
    return packed


def _write_surfaces(folder: Path, tissue: Tissue) -> None:
    mat = _parent_of(folder / "mat" / f"{tissue.name}.mat")
    write_mesh(tissue.mesh, _parent_of(folder / "stl" / f"{tissue.name}.stl"), "stl", tissue.name)
    write_mesh(tissue.mesh, mat, "mat", tissue.name)
    # BEM-FMM finds its files by bare name beside the index: the folder works wherever it is put
    shutil.copyfile(mat, _parent_of(folder / BEM_FMM / mat.name))


def _write_solver_files(folder: Path, tissues: Sequence[Tissue], report: Report) -> None:
    (folder / openmeeg.FOLDER).mkdir()
    openmeeg.write_model(folder / openmeeg.FOLDER, tissues)
    merged = merge(tissues)
    gmsh.write_surfaces(_parent_of(folder / gmsh.FILE), merged)
    _write_text(folder / nastran.FILE, nastran.bulk_data(merged))
    _parent_of(folder / glb.FILE).write_bytes(glb.surfaces_glb(tissues))
    gaps = [pair.min_gap_mm for pair in report.pairs if pair.min_gap_mm]
    _write_text(folder / smesh.FILE, smesh.smesh_text(tissues, min(gaps, default=LONE_MM)))


def _manifest(tissues: Sequence[Tissue], report: Report, files: dict[str, FileEntry]) -> Manifest:
    tags = region_tags(tissues)
    return Manifest(
        process=report.process,
        verdict=report.verdict,
        tissues=tuple(_tissue_entry(tissue, tags[tissue.name], files) for tissue in tissues),
        notes=(FREQUENCY_NOTE, *(_guess_note(tissue) for tissue in tissues if _is_guess(tissue))),
        parameters=report.parameters,
        input_sha256=find_input_checksums(report.parameters),
        software=report.software,
        files=files,
    )


def _tissue_entry(tissue: Tissue, tag: int, files: dict[str, FileEntry]) -> TissueEntry:
    stl, mat = f"stl/{tissue.name}.stl", f"mat/{tissue.name}.mat"
    default = look_up(tissue.name)
    is_default = default.siemens_per_metre == tissue.conductivity_s_per_m
    return TissueEntry(
        name=tissue.name,
        file=stl,
        sha256=files[stl].sha256,
        mat_file=mat,
        mat_sha256=files[mat].sha256,
        vertices=len(tissue.mesh.vertices),
        faces=len(tissue.mesh.faces),
        depth_mm=tissue.depth_mm,
        side=tissue.side,
        conductivity_s_per_m=tissue.conductivity_s_per_m,
        conductivity_source=default.source if is_default else "given with the tissue",
        conductivity_frequency=FREQUENCY if is_default else None,
        enclosing_tissue=tissue.enclosing,
        region_tag=tag,
    )


def _guess_note(tissue: Tissue) -> str:
    value = f"{tissue.conductivity_s_per_m:g} S/m"
    return f"no default conductivity is known for '{tissue.name}': {value} is that of muscle, set your own"


def _is_guess(tissue: Tissue) -> bool:
    default = look_up(tissue.name)
    return not default.known and default.siemens_per_metre == tissue.conductivity_s_per_m


def _with_checksums(report: Report, checksums: dict[str, str]) -> Report:
    meshes = {
        name: mesh.model_copy(update={"sha256": checksums[name]}) if name in checksums else mesh
        for name, mesh in report.meshes.items()
    }
    return report.model_copy(update={"meshes": meshes, "methods": f"{report.methods} {FREQUENCY_NOTE}".strip()})


def _entry(path: Path) -> FileEntry:
    return FileEntry(sha256=_sha256(path), bytes=path.stat().st_size)


def _sha256(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _write_text(path: Path, text: str) -> None:
    _parent_of(path).write_text(text, encoding="utf-8", newline="\n")


def _parent_of(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    return path
