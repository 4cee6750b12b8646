from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from core.errors import InputError
from core.io import canonical, stl_ascii
from core.io.registry import write_mesh
from core.mesh import Mesh
from core.processes import intake
from core.schema.finding import Finding
from subjects.body import body
from tests.solids import cube, tetrahedron


def run(path: Path, file_name: str = "skin.stl", unit: str = "mm") -> dict[str, Any]:
    return intake.run({"path": str(path), "file_name": file_name, "unit": unit, "out_dir": str(path.parent)}, None)


def test_an_upload_becomes_canonical(tmp_path: Path) -> None:
    write_mesh(cube(0.1), tmp_path / "upload", "ply", "x")
    answer = run(tmp_path / "upload", "left arm.ply", "m")
    path = str(tmp_path / "0.mesh")
    (mesh,) = answer["meshes"]
    assert mesh.pop("area_mm2") == pytest.approx(60_000)
    extents = {"extents_mm": [100.0, 100.0, 100.0]}
    assert mesh == {"name": "left arm", "path": path, "vertices": 8, "faces": 12, "arrays": []} | extents
    assert (answer["format"], answer["findings"]) == ("ply", [])
    assert np.array_equal(canonical.load(Path(path)).triangles(), cube(100.0).triangles())


def test_arrays_on_vertices_are_kept_as_they_are_whatever_the_unit_and_described(tmp_path: Path) -> None:
    whole = cube(0.1)
    depths = np.linspace(0.3, 1.0, len(whole.vertices))
    depths[3], depths[5] = np.nan, np.inf
    arrays = {"fat_depth_mm": depths, "row": np.arange(8.0)[None, :], "short_mm": np.ones(7), "note": "a word"}
    scipy.io.savemat(tmp_path / "upload", {"P": whole.vertices, "t": whole.faces + 1.0} | arrays, appendmat=False)
    answer = json.loads(json.dumps(run(tmp_path / "upload", "skin.mat", "m")))
    (mesh,) = answer["meshes"]
    assert mesh["arrays"] == [
        {"name": "fat_depth_mm", "minimum": 0.3, "maximum": 1.0, "not_finite": 2},
        {"name": "row", "minimum": 0.0, "maximum": 7.0, "not_finite": 0},
    ]
    (finding,) = answer["findings"]
    assert (finding["code"], finding["count"]) == ("mat.array_ignored", 1)
    assert "short_mm has 7 numbers for 8 vertices" in finding["message"]
    loaded, kept = canonical.load_with_arrays(Path(mesh["path"]))
    assert np.array_equal(loaded.vertices, whole.vertices * 1000)
    assert np.array_equal(kept["fat_depth_mm"], depths, equal_nan=True)
    assert np.array_equal(kept["row"], np.arange(8.0))


def test_the_answer_is_plain_json_and_findings_can_be_read_back(tmp_path: Path) -> None:
    write_mesh(cube(1.0), tmp_path / "upload", "stl", "x")
    answer = json.loads(json.dumps(run(tmp_path / "upload")))
    assert [Finding.model_validate(finding).code for finding in answer["findings"]] == ["mesh.unit_suspicious"]


def test_several_solids_become_one_welded_mesh(tmp_path: Path) -> None:
    whole = cube(100.0)
    parts = [
        ("front", Mesh.of(whole.vertices, whole.faces[:5])),
        ("back", Mesh.of(whole.vertices, whole.faces[5:])),
        ("", tetrahedron(7.0, 500.0)),
    ]
    content = b""
    for name, part in parts:
        stl_ascii.write(part, tmp_path / "part", name)
        content += (tmp_path / "part").read_bytes()
    (tmp_path / "upload").write_bytes(content)
    answer = run(tmp_path / "upload", "head.stl")
    (mesh,) = answer["meshes"]
    assert (mesh["name"], mesh["vertices"], mesh["faces"]) == ("head", 8 + 4, 12 + 4)
    (finding,) = answer["findings"]
    assert (finding["code"], finding["count"]) == ("mesh.several_solids", 3)
    assert "front (5 faces), back (7 faces), head (4 faces)" in finding["message"]
    loaded = canonical.load(Path(mesh["path"]))
    assert np.array_equal(loaded.triangles()[:12], whole.triangles())


def test_the_names_of_many_solids_are_cut_short(tmp_path: Path) -> None:
    stl_ascii.write(tetrahedron(100.0), tmp_path / "part", "piece")
    (tmp_path / "upload").write_bytes((tmp_path / "part").read_bytes() * 25)
    (finding,) = run(tmp_path / "upload")["findings"]
    assert finding["message"].endswith("piece_20 (4 faces) and 5 more")


@pytest.mark.parametrize(
    ("unit", "content", "code"), [("feet", b"x", "unit.unknown"), ("mm", b"", "upload.empty"), ("mm", b"x", "stl.not_stl")]
)
def test_a_refused_upload_leaves_nothing(tmp_path: Path, unit: str, content: bytes, code: str) -> None:
    (tmp_path / "upload").write_bytes(content)
    with pytest.raises(InputError) as caught:
        run(tmp_path / "upload", unit=unit)
    assert caught.value.code == code
    assert [path.name for path in tmp_path.iterdir()] == ["upload"]


def test_the_body_in_metres_is_taken_in(tmp_path: Path) -> None:
    metres = body(0).with_vertices(body(0).vertices / 1000)
    write_mesh(metres, tmp_path / "upload", "mat", "body")
    answer = run(tmp_path / "upload", "body.mat", "m")
    assert answer["meshes"][0]["faces"] == 26_756
    assert answer["findings"] == []
    wrong = run(tmp_path / "upload", "body.mat", "mm")
    assert [finding["code"] for finding in wrong["findings"]] == ["mesh.unit_suspicious"]
    assert "read as m it would be" in wrong["findings"][0]["message"]
