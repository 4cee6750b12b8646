"""A field for the eye: fewer triangles, each with the value of the triangle it stands for, surfaces apart."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np
import pytest
from numpy.typing import NDArray

from core.fields.mapped import MappedField
from core.mesh import Mesh
from core.package.field_files import write_msh
from core.package.field_preview import write_preview
from core.package.tissue import FREE_SPACE, Tissue
from tests.solids import sphere

OUTER, INNER = sphere(50.0, 4), sphere(20.0, 3)
MOST_FACES = 700
ALL = len(OUTER.faces) + len(INNER.faces)


def field_file(path: Path) -> Path:
    """The value of every triangle is its number, but for those of the outer one that look down: they have none."""
    values = np.arange(1.0, ALL + 1.0)
    values[: len(OUTER.faces)][middles(OUTER)[:, 2] < 0] = np.nan
    parts = {"skin": (OUTER, values[: len(OUTER.faces)]), "bone": (INNER, values[len(OUTER.faces) :])}
    tissues = [Tissue(name, mesh, None, 1.0, FREE_SPACE) for name, (mesh, _) in parts.items()]
    mapped = {name: MappedField(each[:, None], np.zeros(len(each)), "nearest") for name, (_, each) in parts.items()}
    write_msh(path, tissues, mapped)
    return path


def middles(mesh: Mesh) -> NDArray[np.float64]:
    """Of triangles, (F, 3) mm."""
    found: NDArray[np.float64] = mesh.triangles().mean(axis=1)
    return found


def test_every_triangle_has_the_value_of_one_that_was_where_it_is(tmp_path: Path) -> None:
    write_preview(field_file(tmp_path / "field.msh"), tmp_path / "seen.msh", MOST_FACES)
    seen = meshio.read(tmp_path / "seen.msh", file_format="gmsh")
    [faces], [values], [tags] = ([each.data for each in seen.cells], seen.cell_data["magnE"], seen.cell_data["gmsh:physical"])
    assert MOST_FACES / 4 < len(faces) <= MOST_FACES
    assert set(seen.cell_data) == {"magnE", "gmsh:physical", "gmsh:geometrical"}
    runs = np.flatnonzero(np.diff(tags)) + 1
    assert len(runs) == 1, "surface after surface"
    assert faces[: runs[0]].max() < faces[runs[0] :].min(), "with vertices of their own"
    there = seen.points[faces].mean(axis=1)
    known = np.isfinite(values)
    was = np.concatenate([middles(OUTER), middles(INNER)])[values[known].astype(int) - 1]
    cell_mm = 100.0 / (0.75 * np.sqrt(MOST_FACES * len(OUTER.faces) / ALL)) / 0.8**2
    assert np.linalg.norm(there[known] - was, axis=1).max() < np.sqrt(3.0) * cell_mm
    assert np.isnan(values[: runs[0]]).any(), "what has no value has none"
    assert (there[: runs[0]][np.isnan(values[: runs[0]])][:, 2] < cell_mm).all()
    assert np.isfinite(values[runs[0] :]).all()


@pytest.mark.parametrize("most_faces", [ALL, 10 * ALL])
def test_few_faces_stay_as_they_are(tmp_path: Path, most_faces: int) -> None:
    source = field_file(tmp_path / "field.msh")
    write_preview(source, tmp_path / "seen.msh", most_faces)
    was, seen = (meshio.read(path, file_format="gmsh") for path in (source, tmp_path / "seen.msh"))
    np.testing.assert_array_equal(seen.points, was.points)
    np.testing.assert_array_equal(seen.cells[0].data, was.cells[0].data)
    np.testing.assert_array_equal(seen.cell_data["magnE"][0], was.cell_data["magnE"][0])


def test_the_same_field_gives_the_same_bytes(tmp_path: Path) -> None:
    source = field_file(tmp_path / "field.msh")
    for name in "ab":
        write_preview(source, tmp_path / name, MOST_FACES)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
