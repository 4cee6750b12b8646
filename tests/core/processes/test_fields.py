"""`fields` as a process, from the bytes of uploads to its files and report."""

from __future__ import annotations

import csv
import io
import zipfile
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import scipy.io

from core.errors import InputError
from core.io.registry import write_mesh
from core.mesh import Mesh
from core.processes import intake
from subjects.figure_eight import above_head, figure_eight, primary_field, write_ccd
from subjects.fsaverage import fsaverage
from tests.core.processes.test_surface_processes import executed, href
from tests.gmsh_reader import data_in_gmsh, sizes_in_gmsh

COLUMNS = ["-", "x", "y", "z", "Ex", "Ey", "Ez"]


def taken_in(folder: Path, number: int, file_name: str, unit: str = "mm") -> dict[str, Any]:
    """The entry of an upload that lies in the folder."""
    out = folder / f"intake {number}"
    out.mkdir()
    told = intake.run({"path": str(folder / file_name), "file_name": file_name, "unit": unit, "out_dir": str(out)}, None)
    (mesh,) = told["meshes"]
    return {href(number): {"path": mesh["path"], "name": mesh["name"], "sha256": f"{number}" * 64}}


def write_table(path: Path, points: np.ndarray, values: np.ndarray) -> None:
    np.savetxt(path, np.column_stack([np.arange(len(points)), points, values]), fmt="%.9e")


@pytest.fixture(scope="module")
def head() -> Mesh:
    return fsaverage("head")


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory, head: Mesh) -> dict[str, Any]:
    """The primary field of a coil above the head, given at its vertices in metres."""
    folder = tmp_path_factory.mktemp("fields")
    placement = above_head(head.vertices[head.vertices[:, 2].argmax()])
    coil = figure_eight().placed(placement)
    values = primary_field(coil, head.vertices)
    write_mesh(head, folder / "head.stl", "stl", "head")
    write_table(folder / "field.txt", head.vertices / 1000.0, values)
    write_ccd(figure_eight(), folder / "coil.ccd")
    entries = {**taken_in(folder, 0, "head.stl"), **taken_in(folder, 1, "field.txt", "m"), **taken_in(folder, 2, "coil.ccd")}
    inputs = {
        "meshes": {"skin": {"href": href(0)}},
        "field": {"href": href(1)},
        "columns": COLUMNS,
        "coil": {"file": {"href": href(2)}, "placement": placement.tolist()},
    }
    return {**executed("fields", folder, inputs, entries), "values": values, "coil": coil}


def test_the_matlab_file_has_a_value_per_triangle(done: dict[str, Any], head: Mesh, tmp_path: Path) -> None:
    assert done["verdict"] == "simulation_ready"
    with zipfile.ZipFile(done["files"]["fields"]) as archive:
        loaded = scipy.io.loadmat(io.BytesIO(archive.read("mat/skin.mat")))
        (tmp_path / "skin.vtu").write_bytes(archive.read("vtu/skin.vtu"))
        names = set(archive.namelist())
    assert {"README.txt", "statistics.csv", "gmsh/fields.msh", "figures/field_skin.png", "report.json"} < names
    faces = loaded["t"].astype(int) - 1
    assert all(loaded[name].dtype == np.float64 for name in ("P", "t", "E", "magE", "coil_positions", "coil_moments"))
    assert (loaded["E"].shape, loaded["magE"].shape) == ((len(head.faces), 3), (len(head.faces), 1))
    # STL joins vertices at one place, so corners are compared and not numbers of vertices
    np.testing.assert_array_equal(loaded["P"][faces], head.triangles())
    expected = done["values"][head.faces].mean(axis=1)
    np.testing.assert_allclose(loaded["E"], expected, atol=1e-6 * np.abs(expected).max())
    np.testing.assert_allclose(loaded["magE"][:, 0], np.linalg.norm(loaded["E"], axis=1))
    np.testing.assert_allclose(loaded["coil_positions"], done["coil"].positions, atol=1e-5)
    vtu = meshio.read(tmp_path / "skin.vtu")
    np.testing.assert_array_equal(vtu.cell_data["E"][0], loaded["E"])


def test_gmsh_reads_the_field(done: dict[str, Any], head: Mesh) -> None:
    path = done["files"]["msh"]
    assert sizes_in_gmsh(path, dimension=2) == {1005: len(head.faces)}
    found = data_in_gmsh(path)
    assert set(found) == {"E", "magnE", "distance_mm"}
    np.testing.assert_allclose(found["magnE"][:, 0], np.linalg.norm(found["E"], axis=1))


def test_numbers_and_the_coil_are_told(done: dict[str, Any], head: Mesh) -> None:
    report = done["report"]
    numbers = report.fields["skin"]
    assert (numbers.faces, numbers.too_far, numbers.farthest_mm) == (len(head.faces), 0, pytest.approx(0.0, abs=1e-3))
    above = head.vertices[head.vertices[:, 2].argmax()]
    assert np.linalg.norm(np.array(numbers.maximum_at_mm) - above) < 20.0  # under the middle of the coil
    assert report.coil.dipoles == 144
    assert report.coil.inside == 0
    assert report.coil.distance_mm == pytest.approx(6.2, abs=0.1)
    assert "The coil is 6.2" in report.summary
    (row,) = csv.DictReader(io.StringIO(done["files"]["statistics"].read_text()))
    assert float(row["magnitude_maximum_V_per_m"]) == numbers.magnitude.maximum
    assert (row["surface"], row["too_far"], row["maximum_face"]) == ("skin", "0", str(numbers.maximum_face))
    assert report.parameters["field"]["sha256"] == "1" * 64


def test_the_page_shows_numbers_pictures_and_paint(done: dict[str, Any]) -> None:
    page = done["files"]["report_html"].read_text(encoding="utf-8")
    assert "<h2>Field</h2>" in page
    assert "The coil (144 dipoles)" in page
    assert "Field on skin" in page
    assert '"painted": {"name": "magnitude of the field' in page.replace("\\u0022", '"')


def small(folder: Path, mesh: Mesh, points: np.ndarray, **asked: Any) -> dict[str, Any]:
    write_mesh(mesh, folder / "mesh.stl", "stl", "mesh")
    write_table(folder / "field.csv", points, np.ones((len(points), 3)))
    entries = {**taken_in(folder, 0, "mesh.stl"), **taken_in(folder, 1, "field.csv")}
    inputs = {"mesh": {"href": href(0)}, "field": {"href": href(1)}, "columns": COLUMNS, **asked}
    return executed("fields", folder, inputs, entries)


def test_triangles_without_a_value_are_counted_named_and_not_ready(tmp_path: Path, head: Mesh) -> None:
    near = head.vertices[head.vertices[:, 1] > 0]
    done = small(tmp_path, head, near, method="nearest")
    report = done["report"]
    assert done["verdict"] == "not_ready"
    (far,) = report.findings
    assert (far.code, far.count) == ("fields.too_far", report.fields["mesh"].too_far)
    assert 1000 < far.count < len(head.faces)
    assert min(place.point_mm[1] for place in far.places) < -90  # the farthest, at the back of the head
    with zipfile.ZipFile(done["files"]["fields"]) as archive:
        loaded = scipy.io.loadmat(io.BytesIO(archive.read("mat/mesh.mat")))
    assert int(np.isnan(loaded["magE"]).sum()) == far.count
    assert int((loaded["distance_mm"] > 5.0).sum()) == far.count


def test_fields_elsewhere_are_refused_with_a_hint(tmp_path: Path, head: Mesh) -> None:
    with pytest.raises(InputError, match="upload it with that unit") as caught:
        small(tmp_path, head, head.vertices / 1000.0)
    assert caught.value.code == "fields.no_overlap"


def test_surfaces_that_are_not_there(tmp_path: Path, head: Mesh) -> None:
    with pytest.raises(InputError, match="there are mesh") as caught:
        small(tmp_path, head, head.vertices, only=["skull"])
    assert caught.value.code == "fields.surface_unknown"


def test_the_same_job_gives_the_same_bytes(tmp_path: Path) -> None:
    mesh = fsaverage("inner_skull-bem")
    found = []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        done = small(tmp_path / name, mesh, mesh.vertices)
        found.append([done["files"][output].read_bytes() for output in ("fields", "msh", "statistics", "report_html")])
    assert found[0] == found[1]


@pytest.mark.parametrize(
    ("file_name", "content", "code"),
    [
        ("field.txt", b"1 2 3\n", "table.too_few_columns"),
        ("field.csv", b"", "upload.empty"),
        ("field.msh", b"$MeshFormat\n9 0 8\n$EndMeshFormat\n", "msh.unsupported"),
        ("field.msh", b"hello\n", "msh.corrupt"),
        ("solid.txt", b"solid x\nendsolid x\n", "stl.malformed"),
    ],
)
def test_uploads_that_hold_no_field(tmp_path: Path, file_name: str, content: bytes, code: str) -> None:
    (tmp_path / file_name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        taken_in(tmp_path, 0, file_name)
    assert caught.value.code in {code, "mesh.empty"}


def test_the_unit_of_a_coil_is_that_of_its_format(tmp_path: Path) -> None:
    write_ccd(figure_eight(), tmp_path / "coil.ccd")
    taken_in(tmp_path, 0, "coil.ccd", "m")
    with pytest.raises(InputError) as caught:
        taken_in(tmp_path, 1, "coil.ccd", "cm")
    assert caught.value.code == "coil.unit_differs"
