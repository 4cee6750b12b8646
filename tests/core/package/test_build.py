"""The zip against spec section 3: what is in it, that it is true, and that it is the same every time."""

import hashlib
import json
import os
import re
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.io
import yaml

from core.io.registry import read_meshes, write_mesh
from core.package.build import build_package
from core.package.conductivity import FREQUENCY, FREQUENCY_NOTE, look_up
from core.package.manifest import FileEntry, Manifest, TissueEntry
from core.schema.report import Report
from tests.core.package.nested import figures, report, tissues

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    path = tmp_path_factory.mktemp("package") / "package.zip"
    return path, build_package(path, tissues(), report(), figures())


@pytest.fixture(scope="module")
def folder(built, tmp_path_factory):
    """The package as a user unpacks it."""
    target = tmp_path_factory.mktemp("unpacked")
    with zipfile.ZipFile(built[0]) as archive:
        archive.extractall(target)
    return target


def test_content_is_that_of_the_spec(built):
    names = ["skin", "fat", "average_body"]
    with zipfile.ZipFile(built[0]) as archive:
        assert archive.testzip() is None
        assert set(archive.namelist()) == {
            "manifest.json",
            "README.txt",
            *(f"stl/{name}.stl" for name in names),
            *(f"mat/{name}.mat" for name in names),
            *(f"bem-fmm/{name}.mat" for name in names),
            "openmeeg/model.geom",
            "openmeeg/model.cond",
            *(f"openmeeg/{name}.tri" for name in names),
            "glb/surfaces.glb",
            "gmsh/surfaces.msh",
            "nastran/surfaces.nas",
            "tetgen/surfaces.smesh",
            "bem-fmm/tissue_index.txt",
            "bem-fmm/tissue_index.yaml",
            "report/report.html",
            "report/report.json",
            *(f"report/figures/{figure.name}.png" for figure in figures()),
        }
        assert archive.namelist() == sorted(archive.namelist())
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert {entry.external_attr >> 16 for entry in archive.infolist()} == {0o100644}


def test_stl_holds_the_very_mesh(folder):
    for tissue in tissues():
        read = read_meshes(folder / "stl" / f"{tissue.name}.stl", file_name="x.stl", unit="mm").meshes[0].mesh
        np.testing.assert_array_equal(read.triangles(), tissue.mesh.triangles())


def test_stl_is_what_write_mesh_writes(folder, tmp_path):
    write_mesh(tissues()[1].mesh, tmp_path / "fat.stl", "stl", "fat")
    assert (folder / "stl" / "fat.stl").read_bytes() == (tmp_path / "fat.stl").read_bytes()


def test_mat_is_double_counts_from_one_and_equals_the_stl_bit_for_bit(folder):
    for tissue in tissues():
        path = folder / "mat" / f"{tissue.name}.mat"
        assert {(name, kind) for name, _, kind in scipy.io.whosmat(path)} == {
            ("P", "double"),
            ("t", "double"),
            ("normals", "double"),
        }
        mat = scipy.io.loadmat(path)
        assert (mat["t"].min(), mat["t"].max()) == (1, len(mat["P"]))
        from_mat = mat["P"][mat["t"].astype(int) - 1]
        facets = np.frombuffer((folder / "stl" / f"{tissue.name}.stl").read_bytes()[84:], dtype="(3,)<f4,(3,3)<f4,<u2")
        assert facets["f1"].astype(np.float64).tobytes() == np.ascontiguousarray(from_mat).tobytes()
        outward = np.einsum("ij,ij->i", mat["normals"], from_mat.mean(axis=1) - (0.1, 0.2, 0.3))
        assert outward.min() > 0
        np.testing.assert_allclose(np.linalg.norm(mat["normals"], axis=1), 1.0)


def read_tissue_index(path: Path) -> list[tuple[str, str, float, str]]:
    """As BEM-FMM does it: lines that begin with `>`, exactly three colons, fields trimmed, files found beside the index."""
    rows = []
    for line in path.read_text(encoding="ascii").split("\n"):
        if line.startswith(">"):
            assert line.count(":") == 3
            tissue, file, conductivity, enclosing = (field.strip() for field in line[1:].split(":"))
            assert (path.parent / file).is_file()
            rows.append((tissue, file, float(conductivity), enclosing))
    return rows


def test_tissue_index_loads_untouched(folder):
    rows = read_tissue_index(folder / "bem-fmm" / "tissue_index.txt")
    assert rows == [
        ("skin", "skin.mat", 0.465, "FreeSpace"),
        ("fat", "fat.mat", 0.078, "skin"),
        ("average_body", "average_body.mat", 0.16, "fat"),
    ]
    for tissue, file, _, _ in rows:
        assert (folder / "bem-fmm" / file).read_bytes() == (folder / "mat" / f"{tissue}.mat").read_bytes()


def test_yaml_index_names_the_meshes_relative_to_itself(folder):
    shells = yaml.safe_load((folder / "bem-fmm" / "tissue_index.yaml").read_text())["shells"]
    assert list(shells) == ["skin", "fat", "average_body"]
    assert shells["fat"] == [0.078, "skin", "../stl/fat.stl"]
    assert all((folder / "bem-fmm" / file).resolve().is_file() for _, _, file in shells.values())


def test_names_that_yaml_takes_for_something_else_stay_names(tmp_path):
    renamed = tuple(replace(each, name=name) for each, name in zip(tissues(), ["no", "1e3", "null"], strict=True))
    nested = tuple(replace(each, enclosing=name) for each, name in zip(renamed, ["FreeSpace", "no", "1e3"], strict=True))
    build_package(tmp_path / "p.zip", nested, report(), ())
    with zipfile.ZipFile(tmp_path / "p.zip") as archive:
        shells = yaml.safe_load(archive.read("bem-fmm/tissue_index.yaml"))["shells"]
    assert shells["1e3"] == [0.078, "no", "../stl/1e3.stl"]
    assert list(shells) == ["no", "1e3", "null"]


def test_manifest_is_true(folder):
    manifest = Manifest.model_validate_json((folder / "manifest.json").read_bytes())
    assert (manifest.format_version, manifest.units, manifest.verdict) == (1, "mm", "simulation_ready")
    assert [(each.name, each.faces, each.depth_mm, each.enclosing_tissue) for each in manifest.tissues] == [
        ("skin", 512, None, "FreeSpace"),
        ("fat", 512, pytest.approx(1 / 3), "skin"),
        ("average_body", 512, 1.0, "fat"),
    ]
    assert manifest.input_sha256 == {"skin": "cd" * 32}
    assert manifest.parameters["min_gap_mm"] == 0.05
    assert manifest.software["integument-server"] == "0.1.0"
    assert manifest.notes == (FREQUENCY_NOTE,)
    assert {tissue.conductivity_frequency for tissue in manifest.tissues} == {FREQUENCY}
    on_disk = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert set(manifest.files) == on_disk - {"manifest.json"}
    for name, entry in manifest.files.items():
        data = (folder / name).read_bytes()
        assert (hashlib.sha256(data).hexdigest(), len(data)) == (entry.sha256, entry.bytes)
    for tissue in manifest.tissues:
        assert manifest.files[tissue.file].sha256 == tissue.sha256
        assert manifest.files[tissue.mat_file].sha256 == tissue.mat_sha256


def test_report_in_the_package_names_the_delivered_files(built, folder):
    packed = built[1]
    assert Report.model_validate_json((folder / "report" / "report.json").read_bytes()) == packed
    assert packed.methods.endswith(FREQUENCY_NOTE)
    for name, mesh in packed.meshes.items():
        assert mesh.sha256 == hashlib.sha256((folder / "stl" / f"{name}.stl").read_bytes()).hexdigest()
        assert str(mesh.sha256) in (folder / "report" / "report.html").read_text(encoding="utf-8")


def test_an_unknown_tissue_gets_a_note(tmp_path):
    unknown = replace(tissues()[2], name="blubber")
    build_package(tmp_path / "p.zip", (*tissues()[:2], unknown), report(), ())
    with zipfile.ZipFile(tmp_path / "p.zip") as archive:
        manifest = json.loads(archive.read("manifest.json"))
    _, guess = manifest["notes"]
    assert "blubber" in guess
    assert "0.16 S/m" in guess
    own_value = replace(unknown, conductivity_s_per_m=0.05)
    build_package(tmp_path / "q.zip", (*tissues()[:2], own_value), report(), ())
    with zipfile.ZipFile(tmp_path / "q.zip") as archive:
        manifest = json.loads(archive.read("manifest.json"))
        assert ">blubber : blubber.mat : 0.0500 : fat" in archive.read("bem-fmm/tissue_index.txt").decode()
    assert manifest["notes"] == [FREQUENCY_NOTE]
    assert manifest["tissues"][2]["conductivity_source"] == "given with the tissue"
    assert manifest["tissues"][2]["conductivity_frequency"] is None


def test_same_bytes_at_another_time_and_place(built, tmp_path):
    """A second process with another clock zone, hash seed, locale and folder builds the same file."""
    script = (
        "import sys; from pathlib import Path\n"
        "from core.package.build import build_package\n"
        "from tests.core.package.nested import figures, report, tissues\n"
        "build_package(Path(sys.argv[1]), tissues(), report(), figures())\n"
    )
    environment = {
        **os.environ,
        "PYTHONPATH": str(ROOT),
        "PYTHONHASHSEED": "12345",
        "SOURCE_DATE_EPOCH": "1000000000",
        "TZ": "Pacific/Auckland",
        "LC_ALL": "C",
    }
    other = tmp_path / "elsewhere" / "other.zip"
    other.parent.mkdir()
    subprocess.run([sys.executable, "-c", script, str(other)], check=True, env=environment, cwd=tmp_path)
    assert other.read_bytes() == built[0].read_bytes()


def test_nothing_is_left_beside_the_package(built):
    assert [path.name for path in built[0].parent.iterdir()] == ["package.zip"]


def test_readme_is_true(folder):
    text = (folder / "README.txt").read_text(encoding="ascii")
    assert max(map(len, text.splitlines())) <= 105
    for tool in ("MATLAB", "BEM-FMM", "SimNIBS", "gmsh", "OpenMEEG", "MNE", "HFSS"):
        assert tool in text
    for tissue in tissues():
        assert f"{tissue.name} " in text
    lines = text.splitlines()
    start = lines.index("Python") + 2
    snippet = "\n".join(lines[start : lines.index("", start)]).replace('"mat/', f'"{folder}/mat/')
    values: dict[str, np.ndarray] = {}
    exec(compile(snippet, "README", "exec"), values)
    np.testing.assert_array_equal(values["vertices_mm"][values["faces"]], tissues()[0].mesh.triangles())


def test_docs_explain_every_file_and_key(folder):
    text = (ROOT / "docs" / "package.md").read_text(encoding="utf-8")
    for model in (Manifest, TissueEntry, FileEntry):
        for key in model.model_fields:
            assert f"`{key}`" in text, f"docs/package.md does not explain {key}"
    for path in folder.rglob("*"):
        if path.is_file():
            name = path.relative_to(folder).as_posix()
            for tissue in tissues():
                name = name.replace(f"/{tissue.name}.", "/NAME.")
            if name.startswith("report/figures/"):
                name = "report/figures/FIGURE.png"
            assert f"`{name}`" in text, f"docs/package.md does not explain {name}"


def test_example_in_the_docs_runs(built, capsys, monkeypatch):
    monkeypatch.chdir(built[0].parent)
    (example,) = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "package.md").read_text(encoding="utf-8"), re.S)
    exec(compile(example, "docs/package.md", "exec"), {})
    assert capsys.readouterr().out.splitlines() == [
        "skin 512 faces, 0.465 S/m",
        "fat 512 faces, 0.078 S/m",
        "average_body 512 faces, 0.16 S/m",
    ]


def test_documented_conductivities_are_the_ones_used():
    rows = re.findall(
        r"^\| ([^|]+) \|([^|]*)\| ([0-9.]+) \| SimNIBS", (ROOT / "docs" / "package.md").read_text(encoding="utf-8"), re.M
    )
    assert len(rows) == 9
    for name, others, value in rows:
        for each in (name, *filter(None, map(str.strip, others.split(",")))):
            assert look_up(each).known, each
            assert look_up(each).siemens_per_metre == float(value), each
