"""Intake of fields and coils: read, told in numbers, written in canonical form. Runs in the limited child, called by `intake`."""

from __future__ import annotations

from pathlib import Path, PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.coil import Coil
from core.errors import InputError
from core.field_source import FieldMesh, FieldSource, FieldTable
from core.io import ccd, tcd, text_table
from core.io.canonical_coil import save_coil
from core.io.canonical_field import save_field
from core.io.extents import check_extents
from core.io.msh import SIGNATURE, read_msh
from core.io.naming import clean_name
from core.io.unit import MM_PER_UNIT, Unit
from core.schema.finding import Finding

MSH = ".msh"
FEWEST_COLUMNS = 4  # three of a place and one of a magnitude
COILS = {ccd.EXTENSION: (ccd.read_ccd, "m"), tcd.EXTENSION: (tcd.read_tcd, "mm")}


def is_field(path: Path, file_name: str) -> bool:
    """True for gmsh files, and for text whose name says it is a matrix; surfaces as text begin with `solid`."""
    with path.open("rb") as file:
        head = file.read(len(SIGNATURE))
    extension = _extension(file_name)
    if extension in text_table.EXTENSIONS:
        return len(head) > 0 and head.lstrip()[:5].lower() != b"solid"
    return head == SIGNATURE or (extension == MSH and len(head) > 0)


def is_coil(path: Path, file_name: str) -> bool:
    """By its name: coils are text of two kinds, of which nothing else can be told."""
    return _extension(file_name) in COILS and path.stat().st_size > 0


def take_in_field(path: Path, file_name: str, unit: Unit, out_dir: Path) -> dict[str, Any]:
    """As `intake.run` of a mesh, with "field": what there is in it; vertices and faces are 0.

    Raises: as `core.io.msh.read_msh`, `core.io.text_table.read_table`; InputError `table.too_few_columns`."""
    target, name = out_dir / "0.mesh", clean_name(Path(file_name).stem, "field")
    findings: tuple[Finding, ...] = ()
    if _extension(file_name) in text_table.EXTENSIONS and not _begins_as_msh(path):
        table = text_table.read_table(path)
        if len(table.names) < FEWEST_COLUMNS:
            raise InputError(
                "table.too_few_columns",
                f"the matrix has {len(table.names)} columns; x, y, z and a field need {FEWEST_COLUMNS} or more",
                columns=len(table.names),
            )
        rows = FieldTable(table.names, table.columns, MM_PER_UNIT[unit])
        field: FieldSource = rows
        extents, about, format_ = np.zeros(3), _describe_table(rows), "table"
    else:
        mesh, findings = read_msh(path, unit)
        field, extents, format_ = mesh, np.ptp(mesh.nodes, axis=0), "msh"
        findings, about = (*findings, *check_extents(extents, unit, name)), _describe_mesh(mesh)
    save_field(field, target)
    return {**_taken(format_, name, target, extents, findings), "field": about}


def take_in_coil(path: Path, file_name: str, unit: Unit, out_dir: Path) -> dict[str, Any]:
    """As `intake.run` of a mesh, with "coil": {"dipoles", "wire_pieces"}; the format tells the unit.

    Raises: InputError `coil.*`, `table.*`; LimitError `coil.too_large`, `table.too_large`."""
    read, own = COILS[_extension(file_name)]
    if unit not in ("mm", own):
        raise InputError("coil.unit_differs", f"{unit} was said of the coil; files {_extension(file_name)} are in {own}")
    coil, findings = read(path)
    target = out_dir / "0.mesh"
    save_coil(coil, target)
    name = clean_name(Path(file_name).stem, "coil")
    extents = np.ptp(coil.places(), axis=0)
    taken = _taken(_extension(file_name).removeprefix("."), name, target, extents, findings)
    return {**taken, "coil": _describe_coil(coil)}


def _extension(file_name: str) -> str:
    return PurePath(file_name).suffix.lower()


def _begins_as_msh(path: Path) -> bool:
    with path.open("rb") as file:
        return file.read(len(SIGNATURE)) == SIGNATURE


def _taken(format_: str, name: str, target: Path, extents: NDArray[np.float64], findings: tuple[Finding, ...]) -> dict[str, Any]:
    mesh = {"name": name, "path": str(target), "vertices": 0, "faces": 0, "extents_mm": extents.tolist(), "arrays": []}
    return {"format": format_, "meshes": [mesh], "findings": [finding.model_dump(mode="json") for finding in findings]}


def _describe_table(table: FieldTable) -> dict[str, Any]:
    count, rows = table.columns.shape
    return {
        "rows": rows,
        "columns": list(table.names),
        "nodes": 0,
        "triangles": 0,
        "tetrahedra": 0,
        "data": [],
        "numbers": count * rows,
    }


def _describe_mesh(mesh: FieldMesh) -> dict[str, Any]:
    data = [{"name": each.name, "where": each.where, "components": each.values.shape[1]} for each in mesh.data]
    return {
        "rows": 0,
        "columns": [],
        "nodes": len(mesh.nodes),
        "triangles": len(mesh.triangles),
        "tetrahedra": len(mesh.tetrahedra),
        "data": data,
        "numbers": mesh.nodes.size + mesh.triangles.size + mesh.tetrahedra.size + sum(each.values.size for each in mesh.data),
    }


def _describe_coil(coil: Coil) -> dict[str, Any]:
    return {"dipoles": len(coil.positions), "wire_pieces": len(coil.wire)}
