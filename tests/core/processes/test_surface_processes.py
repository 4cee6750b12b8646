"""`heal`, `decimate` and `smooth`: one surface, several by name, a package; what is kept, and what is refused."""

import hashlib
import json
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError, IntegumentError, InternalError
from core.io import canonical
from core.mesh import Mesh
from core.package.build import build_package
from core.package.read import read_package
from core.processes.loaded_surfaces import LoadedSurfaces
from core.processes.registry import run
from core.processes.surface_package import SurfaceJob, deliver_surfaces
from core.run import SILENT
from core.schema.finding import Severity
from core.schema.report import Report
from core.validation.regressions import find_regressions
from core.validation.validate import validate
from subjects.defects import CORPUS
from tests.core.package.nested import figures, report, tissues
from tests.solids import sphere, together, without_faces

PACKAGE = "/v1/jobs/00000000-0000-0000-0000-000000000001/results/package"
ZIPPED = {"media_type": "application/zip", "file_name": "package.zip"}
DEFECTIVE = "ball, bodies sharing an edge + scraps outside + inside out"
HALF = {"target_ratio": 0.5}
PROCESSES: dict[str, dict[str, Any]] = {"heal": {}, "decimate": HALF, "smooth": {"iterations": 3}}


class Phases:
    """Takes events and keeps the phases."""

    def __init__(self) -> None:
        self.seen: list[tuple[float, str]] = []

    def send(self, message: dict[str, Any]) -> None:
        self.seen.append((message["progress"], str(message["phase"])))


def href(number: int) -> str:
    return f"/v1/meshes/00000000-0000-0000-0000-{number:012d}"


def stored(folder: Path, meshes: Mapping[str, Mesh]) -> dict[str, dict[str, Any]]:
    entries = {}
    for number, (name, mesh) in enumerate(meshes.items()):
        path = folder / f"{number}.mesh"
        canonical.save(mesh, path)
        entries[href(number)] = {"path": str(path), "name": name, "sha256": f"{number:064d}"}
    return entries


def executed(process: str, folder: Path, inputs: Mapping[str, Any], entries: Mapping[str, Any]) -> dict[str, Any]:
    """The result of the registry; its paths by the names of outputs, its report read."""
    out = folder / "out"
    out.mkdir(exist_ok=True)
    phases = Phases()
    result = run({"process": process, "inputs": dict(inputs), "meshes": entries, "out_dir": str(out)}, phases)
    assert [progress for progress, _ in phases.seen] == sorted(progress for progress, _ in phases.seen)
    files = {output["name"]: Path(output["path"]) for output in result["outputs"]}
    return {**result, "files": files, "report": Report.model_validate_json(files["report"].read_bytes())}


def of_one(process: str, folder: Path, mesh: Mesh, **inputs: Any) -> dict[str, Any]:
    return executed(process, folder, {"mesh": {"href": href(0)}, **inputs}, stored(folder, {"ball": mesh}))


def of_package(process: str, folder: Path, path: Path, **inputs: Any) -> dict[str, Any]:
    entry = {
        "path": str(path),
        "name": "package",
        "sha256": "1" * 64,
        "media_type": "application/zip",
        "file_name": "package.zip",
    }
    return executed(process, folder, {"package": {"href": PACKAGE}, **inputs}, {PACKAGE: entry})


def packed(path: Path) -> Path:
    """Three spheres about a tenth of a millimetre apart, one of them with a conductivity of its own."""
    changed = [replace(tissue, conductivity_s_per_m=0.2) if tissue.name == "fat" else tissue for tissue in tissues()]
    build_package(path, changed, report(), figures())
    return path


@pytest.mark.parametrize("process", PROCESSES)
def test_one_surface_gives_one_surface_and_a_report(process: str, tmp_path: Path) -> None:
    result = of_one(process, tmp_path, sphere(50, 3), **PROCESSES[process])
    assert result["verdict"] == "simulation_ready"
    assert set(result["files"]) == {"mesh", "report", "report_html"}
    told: Report = result["report"]
    assert told.comparisons["mesh"].before.faces == len(sphere(50, 3).faces)
    assert told.parameters["mesh"] == {"name": "ball", "sha256": "0" * 64}
    assert "float32" in told.changes[0]["what"]  # a sphere is not what float32 holds
    assert told.methods.endswith("in the middles of faces.")
    page = result["files"]["report_html"].read_text(encoding="utf-8")
    assert "Before and after" in page
    assert "data:image/png" in page
    (measured,) = result["report"].meshes.values()
    (surface,) = (path for name, path in result["files"].items() if not name.startswith("report"))
    assert measured.sha256 == hashlib.sha256(surface.read_bytes()).hexdigest()
    assert measured.sha256 in result["files"]["report_html"].read_text(encoding="utf-8")


@pytest.mark.parametrize("process", PROCESSES)
def test_a_package_stays_a_package(process: str, tmp_path: Path) -> None:
    source = packed(tmp_path / "package.zip")
    result = of_package(process, tmp_path, source, **PROCESSES[process])
    assert result["verdict"] == "simulation_ready"
    assert set(result["files"]) == {"package", "skin", "fat", "average_body", "report", "report_html"}
    before, after = read_package(source), read_package(result["files"]["package"])
    keys = ("name", "depth_mm", "conductivity_s_per_m", "enclosing_tissue", "side")
    assert [[getattr(tissue, key) for key in keys] for tissue in after.manifest.tissues] == [
        [getattr(tissue, key) for key in keys] for tissue in before.manifest.tissues
    ]
    assert after.manifest.input_sha256 == {"package": "1" * 64}
    proof = validate(after.surfaces, min_gap_mm=0.05)
    assert proof.verdict == "simulation_ready"
    assert proof.nesting == {"skin": None, "fat": "skin", "average_body": "fat"}
    for name, mesh in after.surfaces.items():
        if process == "decimate":
            assert len(mesh.faces) <= 0.5 * len(before.surfaces[name].faces) + 1
        if process == "heal":
            assert np.array_equal(mesh.triangles(), before.surfaces[name].triangles())


def test_several_surfaces_are_packed_in_nesting_order(tmp_path: Path) -> None:
    balls = {"inner": sphere(20, 2), "outer": sphere(30, 2), "beside": sphere(5, 2, at=(100, 0, 0))}
    entries = stored(tmp_path, balls)
    inputs = {"meshes": {name: {"href": link} for name, link in zip(balls, entries, strict=True)}}
    result = executed("decimate", tmp_path, {**inputs, "target_faces": 480}, entries)
    manifest = read_package(result["files"]["package"]).manifest
    assert [(tissue.name, tissue.enclosing_tissue) for tissue in manifest.tissues] == [
        ("outer", "FreeSpace"),
        ("inner", "outer"),
        ("beside", "FreeSpace"),
    ]
    assert sum(tissue.faces for tissue in manifest.tissues) <= 480
    assert set(result["report"].parameters["meshes"]) == set(balls)


def test_same_bytes_again(tmp_path: Path) -> None:
    results = []
    for folder in (tmp_path / "first", tmp_path / "second"):
        folder.mkdir()
        results.append(of_one("decimate", folder, sphere(50, 3), **HALF))
    for name in ("mesh", "report", "report_html"):
        assert results[0]["files"][name].read_bytes() == results[1]["files"][name].read_bytes()


def test_an_open_surface_is_smoothed_and_called_not_ready(tmp_path: Path) -> None:
    ball = sphere(50, 3)
    bowl = without_faces(ball, np.flatnonzero(ball.triangles()[:, :, 2].min(axis=1) > 20))
    result = of_one("smooth", tmp_path, bowl, iterations=2)
    assert result["verdict"] == "not_ready"
    assert "mesh.not_closed" in {finding.code for finding in result["report"].findings}
    assert result["report"].comparisons["mesh"].volume_change is None


def test_defects_are_healed_and_listed_with_places(tmp_path: Path) -> None:
    (entry,) = [entry for entry in CORPUS if entry.name == DEFECTIVE]
    result = of_one("heal", tmp_path, entry.make())
    assert result["verdict"] == "simulation_ready"
    places = [place for change in result["report"].changes for place in change.get("places", ())]
    assert places
    page = result["files"]["report_html"].read_text(encoding="utf-8")
    assert "Changes: mesh" in page


def test_surfaces_that_cross_are_healed_one_by_one_and_called_not_ready(tmp_path: Path) -> None:
    entries = stored(tmp_path, {"a": without_faces(sphere(30, 2), [0]), "b": sphere(30, 2, at=(20, 0, 0))})
    inputs = {"meshes": {name: {"href": link} for name, link in zip("ab", entries, strict=True)}}
    result = executed("heal", tmp_path, inputs, entries)
    assert result["verdict"] == "not_ready"
    told: Report = result["report"]
    assert {finding.code for finding in told.findings if finding.severity is Severity.ERROR} == {"pair.intersecting"}
    assert all(mesh.closed for mesh in told.meshes.values())
    assert read_package(result["files"]["package"]).manifest.verdict == "not_ready"


def test_a_refusal_says_which_surface_of_a_set_it_is_about(tmp_path: Path) -> None:
    scrap = Mesh.of([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)])
    entries = stored(tmp_path, {"good": sphere(30, 2), "scrap": scrap})
    inputs = {"meshes": {name: {"href": link} for name, link in zip(("good", "scrap"), entries, strict=True)}}
    with pytest.raises(InputError, match=r"^scrap: ") as refusal:
        executed("heal", tmp_path, inputs, entries)
    assert refusal.value.code == "heal.nothing_left"


BALL = sphere(50, 2)
BOX = {"min": [900, 0, 0], "max": [950, 50, 50]}
REFUSED: dict[str, tuple[str, Mesh, dict[str, Any], str]] = {
    "open": ("decimate", without_faces(BALL, [0]), HALF, "surface.not_closed"),
    "crossing itself": ("decimate", together(BALL, sphere(50, 2, at=(30, 0, 0))), HALF, "surface.self_intersecting"),
    "region beside the mesh": (
        "decimate",
        BALL,
        {**HALF, "regions": [{"name": "nowhere", "box_mm": BOX, "ratio": 1.0}]},
        "region.outside_mesh",
    ),
    "smoothed beside the mesh": ("smooth", BALL, {"regions": [{"name": "nowhere", "box_mm": BOX}]}, "region.outside_mesh"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_unfit_input_is_refused_with_a_report(case: str, tmp_path: Path) -> None:
    process, mesh, inputs, code = REFUSED[case]
    with pytest.raises(InputError) as refusal:
        of_one(process, tmp_path, mesh, **inputs)
    assert refusal.value.code == code
    assert {output["name"] for output in refusal.value.outputs} == {"report", "report_html"}


def test_what_is_no_package_is_refused(tmp_path: Path) -> None:
    bad = tmp_path / "package.zip"
    bad.write_bytes(b"no zip")
    with pytest.raises(InputError) as refusal:
        of_package("heal", tmp_path, bad)
    assert refusal.value.code == "package.corrupt"
    good, newer = packed(tmp_path / "good.zip"), tmp_path / "newer.zip"
    with zipfile.ZipFile(good) as source, zipfile.ZipFile(newer, "w") as target:
        for name in source.namelist():
            data = source.read(name)
            if name == "manifest.json":
                data = json.dumps({**json.loads(data), "format_version": 2}).encode()
            target.writestr(name, data)
    with pytest.raises(InputError, match="format version 2"):
        of_package("heal", tmp_path, newer)


def test_a_refused_package_is_drawn_with_the_places(tmp_path: Path) -> None:
    with pytest.raises(InputError) as refusal:
        of_package("smooth", tmp_path, packed(tmp_path / "package.zip"), min_gap_mm=9.0)
    assert refusal.value.code == "surfaces.too_close"


@pytest.mark.parametrize(
    ("made", "words"),
    [(without_faces(BALL, [0]), "no longer closed"), (together(BALL, sphere(5, 1)), "components 2")],
)
def test_what_is_not_proven_is_not_handed_out(made: Mesh, words: str, tmp_path: Path) -> None:
    before = validate({"mesh": BALL})
    job = SurfaceJob(
        process="decimate",
        not_proven="decimate.not_proven",
        source=LoadedSurfaces({"mesh": BALL}, {}, {}, (), {"mesh": 0.16}, together=False),
        before=before,
        made={"mesh": made.rounded_to_float32()},
        min_gap_mm=0.05,
        summary=lambda _report: "",
        find_broken=lambda after, _deviations: find_regressions(before, after, 0.05),
        methods="",
        references=(),
        parameters={},
    )
    with pytest.raises(InternalError, match=words) as failure:
        deliver_surfaces(job, SILENT, tmp_path)
    assert failure.value.code == "decimate.not_proven"
    assert isinstance(failure.value, IntegumentError)
    assert failure.value.report is not None
    assert failure.value.report.comparisons
