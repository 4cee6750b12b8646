"""A solver's field over HTTP: uploaded as text and as gmsh, brought onto the tissues of a package, the coil beside the head."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

import meshio
import numpy as np
import pytest
import scipy.io

from subjects.figure_eight import above_head, figure_eight, primary_field, write_ccd
from tests.acceptance.service import Service, unpack_shells
from tests.solids import sphere

HEAD = sphere(80.0, 3)
NAMES = ["x", "y", "z", "Ex", "Ey", "Ez"]
PLACEMENT = above_head(np.array([0.0, 0.0, 80.0]))
COIL = figure_eight().placed(PLACEMENT)


@pytest.fixture
def coil(service: Service, tmp_path: Path) -> str:
    write_ccd(figure_eight(), tmp_path / "coil.ccd")
    return service.upload_file((tmp_path / "coil.ccd").read_bytes(), "coil.ccd", "mm")


def as_text(points: np.ndarray) -> bytes:
    out = io.BytesIO()
    np.savetxt(out, np.column_stack([points, primary_field(COIL, points)]), delimiter=",", header=",".join(NAMES), comments="")
    return out.getvalue()


def test_text_comes_back_on_every_tissue_of_a_package(service: Service, coil: str) -> None:
    skin = service.upload(HEAD)
    shells = service.shells(skin, layers=[{"name": "fat", "depth_mm": 2.0}])
    service.succeed(shells)
    tissues = unpack_shells(service.result(shells, "package"))
    points = np.concatenate([mesh.vertices for mesh in tissues.values()])
    field = service.upload_file(as_text(points), "field.csv", "mm")
    told = service.http.get(field).json()
    assert (told["format"], told["faces"], told["field"]["columns"]) == ("table", 0, NAMES)
    assert told["field"]["rows"] == len(points)
    assert service.http.get(coil).json()["coil"] == {"dipoles": 144, "wire_pieces": 0}
    inputs = {
        "package": {"href": f"/v1/jobs/{shells}/results/package"},
        "field": {"href": field},
        "coil": {"file": {"href": coil}, "placement": PLACEMENT.tolist()},
    }
    job = service.execute("fields", inputs)
    assert service.succeed(job)["verdict"] == "simulation_ready"
    report = service.report(job)
    assert set(report["fields"]) == {"skin", "fat"}
    assert report["coil"]["distance_mm"] == pytest.approx(
        6.0, abs=1.5
    )  # the middle of the coil is 6 mm above, its rims curve away
    with zipfile.ZipFile(io.BytesIO(service.result(job, "fields"))) as archive:
        for name, mesh in tissues.items():
            loaded = scipy.io.loadmat(io.BytesIO(archive.read(f"mat/{name}.mat")))
            np.testing.assert_allclose(loaded["P"][loaded["t"].astype(int) - 1], mesh.triangles(), atol=1e-9)
            expected = primary_field(COIL, mesh.vertices)[mesh.faces].mean(axis=1)
            np.testing.assert_allclose(loaded["E"], expected, rtol=1e-6, atol=1e-6)
    assert b"magnitude_maximum" in service.result(job, "statistics")


def test_a_gmsh_file_comes_back_on_its_own_surface(service: Service, tmp_path: Path) -> None:
    values = primary_field(COIL, HEAD.triangles().mean(axis=1))
    mesh = meshio.Mesh(HEAD.vertices, [("triangle", HEAD.faces)], cell_data={"E": [values]})
    meshio.write(tmp_path / "field.msh", mesh, file_format="gmsh22", binary=True)
    field = service.upload_file((tmp_path / "field.msh").read_bytes(), "field.msh", "mm")
    assert service.http.get(field).json()["field"]["data"] == [{"name": "E", "where": "elements", "components": 3}]
    job = service.execute("fields", {"mesh": {"href": service.upload(HEAD)}, "field": {"href": field}})
    assert service.succeed(job)["verdict"] == "simulation_ready"
    (numbers,) = service.report(job)["fields"].values()
    assert numbers["magnitude"]["maximum"] == pytest.approx(np.linalg.norm(values, axis=1).max())


def test_everything_has_its_place(service: Service, coil: str) -> None:
    skin, field = service.upload(HEAD), service.upload_file(as_text(HEAD.vertices), "field.csv", "mm")

    def refused(process: str, inputs: object) -> str:
        reply = service.http.post(f"/v1/processes/{process}/execution", json={"inputs": inputs})
        assert reply.status_code == 422, reply.text
        return str(reply.json()["code"])

    assert refused("fields", {"mesh": {"href": skin}, "field": {"href": skin}}) == "reference.not_a_field"
    assert refused("fields", {"mesh": {"href": skin}, "field": {"href": coil}}) == "reference.not_a_field"
    assert refused("fields", {"mesh": {"href": field}, "field": {"href": field}}) == "reference.not_a_mesh"
    wrong = {"file": {"href": field}}
    assert refused("fields", {"mesh": {"href": skin}, "field": {"href": field}, "coil": wrong}) == "reference.not_a_coil"
    scaled = {"file": {"href": coil}, "placement": (2 * np.eye(4)).tolist()}
    assert refused("fields", {"mesh": {"href": skin}, "field": {"href": field}, "coil": scaled}) == "inputs.invalid"
    assert refused("fields", {"mesh": {"href": skin}}) == "inputs.invalid"
    assert refused("heal", {"mesh": {"href": coil}}) == "reference.not_a_mesh"
    for upload, code in ((field, "mesh.is_a_field"), (coil, "mesh.is_a_coil")):
        reply = service.http.get(f"{upload}/file?format=stl")
        assert (reply.status_code, reply.json()["code"]) == (422, code)


@pytest.mark.parametrize(
    ("name", "content", "code"),
    [
        ("field.csv", b"x,y,z,E\n1,2,3\n1,2,3,4\n", "table.ragged"),
        ("field.csv", b"1 " * 1_000_000, "table.line_too_long"),
        ("field.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n900000000000\n1 0 0 0\n$EndNodes\n", "msh.corrupt"),
        ("coil.tcd", b"[" * 200_000, "coil.corrupt"),
        ("coil.ccd", b"2\n0 0 0 0 0 1\n80 0 0 0 0 1\n", "coil.size"),
    ],
)
def test_hostile_files_are_refused_by_name(service: Service, name: str, content: bytes, code: str) -> None:
    reply = service.http.post("/v1/meshes", files={"file": (name, content, "application/octet-stream")})
    assert (reply.status_code, reply.json()["code"]) == (422, code), reply.text


def test_columns_that_are_missing_fail_the_job_with_a_report(service: Service) -> None:
    field = service.upload_file(as_text(HEAD.vertices), "field.csv", "mm")
    inputs = {"mesh": {"href": service.upload(HEAD)}, "field": {"href": field}, "columns": ["x", "y", "Ex", "Ey"]}
    job = service.execute("fields", inputs)
    status = service.wait(job)
    assert (status["status"], status["failure"]["code"]) == ("failed", "fields.columns_missing")
    assert "the columns named are x, y, Ex, Ey" in service.report(job)["summary"]
