"""A field on surfaces as files: MATLAB, ParaView, gmsh and a table of numbers."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from core.coil import Coil
from core.fields.mapped import MappedField
from core.io.mat import surface_arrays, write_arrays
from core.mesh import Mesh
from core.package.merged_surfaces import merge
from core.package.region_tag import SURFACE
from core.package.tissue import Tissue
from core.schema.report import FieldNumbers, FieldReport

Floats = NDArray[np.float64]
VECTOR, MAGNITUDE, DISTANCE = "E", "magE", "distance_mm"
SIMNIBS_MAGNITUDE = "magnE"
PARTS = ("magnitude", "normal", "tangential")
QUANTITIES = ("mean", "percentile_99", "maximum")


def write_mat(path: Path, surface: Mesh, mapped: MappedField, coil: Coil | None) -> None:
    """P, t from 1, normals, E (F, 3), magE (F, 1), distance_mm (F, 1), all double; NaN where there is no value. Of magnitudes
    alone there is no E. With a coil: its dipoles as coil_positions, coil_moments, and coil_wire, coil_wire_along."""
    arrays = surface_arrays(surface)
    if mapped.is_vector:
        arrays[VECTOR] = mapped.values
    arrays |= {MAGNITUDE: mapped.magnitude[:, None], DISTANCE: mapped.distance_mm[:, None]}
    if coil is not None:
        arrays |= {"coil_positions": coil.positions, "coil_moments": coil.moments}
        if len(coil.wire):
            arrays |= {"coil_wire": coil.wire, "coil_wire_along": coil.wire_along}
    write_arrays(path, arrays)


def write_vtu(path: Path, surface: Mesh, mapped: MappedField) -> None:
    """Triangles with E, magE and distance_mm."""
    mesh = meshio.Mesh(
        surface.vertices,
        [("triangle", surface.faces.astype(np.int64))],
        cell_data={name: [values] for name, values in _quantities(mapped).items()},
    )
    meshio.write(path, mesh, file_format="vtu", binary=True)


def write_msh(path: Path, tissues: Sequence[Tissue], mapped: Mapping[str, MappedField]) -> None:
    """gmsh 2.2 binary, all surfaces with tags 1000 + n, E and magnE as `ElementData`, named as SimNIBS names them.

    Element data of a .msh goes over all elements: a triangle without a value has NaN."""
    surfaces = merge(tissues)
    rows = [_quantities(mapped[tissue.name]) for tissue in tissues]
    data = {name: np.concatenate([each[name] for each in rows]) for name in rows[0]}
    data[SIMNIBS_MAGNITUDE] = data.pop(MAGNITUDE)
    write_triangles(path, surfaces.vertices, surfaces.faces, surfaces.tags + SURFACE, data)


def write_triangles(
    path: Path, vertices: Floats, faces: NDArray[np.int64], tags: NDArray[np.int64], data: Mapping[str, Floats]
) -> None:
    """gmsh 2.2 binary; tags and data: a row per triangle."""
    mesh = meshio.Mesh(
        vertices,
        [("triangle", faces)],
        cell_data={**{name: [values] for name, values in data.items()}, "gmsh:physical": [tags], "gmsh:geometrical": [tags]},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=True)


def write_statistics(path: Path, reports: Mapping[str, FieldReport]) -> None:
    """One row per surface; V/m and mm; empty where there is no number."""
    with path.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        named = [f"{part}_{quantity}_V_per_m" for part in PARTS for quantity in QUANTITIES]
        rows.writerow(
            [
                *("surface", "faces", "too_far", "area_with_value_mm2", "farthest_mm", *named),
                *("maximum_x_mm", "maximum_y_mm", "maximum_z_mm", "maximum_face"),
            ]
        )
        for name, report in reports.items():
            numbers = [_told(getattr(report, part), quantity) for part in PARTS for quantity in QUANTITIES]
            place = report.maximum_at_mm or ("", "", "")
            counts = (report.faces, report.too_far, repr(report.area_with_value_mm2), repr(report.farthest_mm))
            rows.writerow([name, *counts, *numbers, *place, report.maximum_face or ""])


def _told(numbers: FieldNumbers | None, quantity: str) -> str:
    return "" if numbers is None else repr(getattr(numbers, quantity))


def _quantities(mapped: MappedField) -> dict[str, Floats]:
    vector = {VECTOR: mapped.values} if mapped.is_vector else {}
    return {**vector, MAGNITUDE: mapped.magnitude, DISTANCE: mapped.distance_mm}
