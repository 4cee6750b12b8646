"""The process `graft` on the real body: the thesis' own case, and unfit input."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import igl
import numpy as np
import pytest

from core.errors import InputError, InternalError
from core.io import canonical
from core.io.registry import read_meshes
from core.mesh import Mesh
from core.processes.graft import _require_proven
from core.processes.registry import run
from core.schema.report import Report
from core.schema.shells import Layer, ShellsInputs
from core.shells.nested_shells import create_shells
from core.validation.validate import validate
from subjects.body import body
from tests.solids import flipped, sphere, together, without_faces

BASE, DONOR = (f"/v1/meshes/00000000-0000-0000-0000-00000000000{digit}" for digit in "12")
EARS = [
    {"name": "right_ear", "box_mm": {"min": [-120, 670, 0], "max": [-62, 760, 80]}},
    {"name": "left_ear", "box_mm": {"min": [62, 670, 0], "max": [120, 760, 80]}},
]
TOP = [{"name": "top", "box_mm": {"min": [-100, -100, 20], "max": [100, 100, 100]}}]


class Silent:
    """Takes events and keeps the phases."""

    def __init__(self) -> None:
        self.phases: list[str] = []

    def send(self, message: dict[str, Any]) -> None:
        self.phases.append(str(message["phase"]))


def run_graft(folder: Path, base: Mesh, donor: Mesh, regions: list[dict[str, Any]], **inputs: Any) -> dict[str, Any]:
    """The result of the registry; its paths by the names of outputs."""
    meshes = {}
    for href, name, mesh in ((BASE, "shell", base), (DONOR, "thin shell", donor)):
        path = folder / f"{name}.mesh"
        canonical.save(mesh, path)
        meshes[href] = {"path": str(path), "name": name, "sha256": "0" * 64}
    asked = {"base": {"href": BASE}, "donor": {"href": DONOR}, "regions": regions, **inputs}
    result = run({"process": "graft", "inputs": asked, "meshes": meshes, "out_dir": str(folder)}, Silent())
    return {**result, "files": {output["name"]: Path(output["path"]) for output in result["outputs"]}}


def delivered(result: Mapping[str, Any]) -> Mesh:
    return read_meshes(result["files"]["mesh"], file_name="mesh.stl", unit="mm").meshes[0].mesh


@pytest.fixture(scope="module")
def shells() -> dict[float, Mesh]:
    """The layers at 0.3 mm and 1 mm of the body of 26,756 faces, each made on its own."""
    made = {}
    for depth_mm in (0.3, 1.0):
        inputs = ShellsInputs.model_validate({"skin": {"href": BASE}, "layers": [Layer(name="fat", depth_mm=depth_mm)]})
        (shell,) = create_shells(body(0), inputs)
        made[depth_mm] = shell.mesh.rounded_to_float32()
    return made


def subdivided(mesh: Mesh) -> Mesh:
    return Mesh.of(*igl.loop(mesh.vertices, mesh.faces)).rounded_to_float32()


def test_ears_of_the_thin_shell_in_the_thick_one(shells: dict[float, Mesh], tmp_path: Path) -> None:
    result = run_graft(tmp_path, shells[1.0], shells[0.3], EARS)
    assert result["verdict"] == "simulation_ready"
    made = delivered(result)
    validation = validate({"skin": body(0), "made": made}, min_gap_mm=0.05)
    assert validation.verdict == "simulation_ready", validation.findings
    assert validation.nesting == {"skin": None, "made": "skin"}
    assert validation.meshes["made"].genus == 0
    have = {row.tobytes() for row in made.vertices + 0.0}
    low, high = np.array([[62, 670, 0], [120, 760, 80]])
    mirrored = np.abs(shells[1.0].vertices * (1, 0, 0)) + shells[1.0].vertices * (0, 1, 1)
    outside = ((mirrored < low - 12) | (mirrored > high + 12)).any(axis=1)
    assert {row.tobytes() for row in shells[1.0].vertices[outside] + 0.0} <= have
    mirrored = np.abs(shells[0.3].vertices * (1, 0, 0)) + shells[0.3].vertices * (0, 1, 1)
    inside = ((mirrored > low + 6) & (mirrored < high - 6)).all(axis=1)
    assert inside.sum() > 500
    assert {row.tobytes() for row in shells[0.3].vertices[inside] + 0.0} <= have

    report = Report.model_validate_json(result["files"]["report"].read_bytes())
    seams = [change for change in report.changes if str(change["what"]).startswith("seam")]
    assert len(seams) == 2
    bridged = next(change["largest_mm"] for change in report.changes if "largest_mm" in change)
    assert 0.65 < bridged < 1.5
    assert report.meshes["mesh"].quality.minimum >= 0.05
    assert {finding.code for finding in report.findings} == {"graft.seam"}
    page = result["files"]["report_html"].read_text(encoding="utf-8")
    assert "region taken out" in page
    assert "data:image/png" in page


@pytest.mark.parametrize("finer", ["base", "donor"])
def test_connectivities_may_differ(finer: str, shells: dict[float, Mesh], tmp_path: Path) -> None:
    base, donor = shells[1.0], shells[0.3]
    result = run_graft(
        tmp_path, subdivided(base) if finer == "base" else base, subdivided(donor) if finer == "donor" else donor, EARS
    )
    assert result["verdict"] == "simulation_ready"
    assert validate({"made": delivered(result)}).verdict == "simulation_ready"


def test_a_decimated_donor(shells: dict[float, Mesh], tmp_path: Path) -> None:
    vertices, faces, *_ = igl.qslim(shells[0.3].vertices, shells[0.3].faces.astype(np.int64), 18_000)
    donor = Mesh.of(vertices, faces).rounded_to_float32()
    assert validate({"donor": donor}).verdict == "simulation_ready"
    result = run_graft(tmp_path, shells[1.0], donor, EARS)
    assert validate({"made": delivered(result)}).verdict == "simulation_ready"


def test_same_bytes_again_and_what_was_rounded_is_told(tmp_path: Path) -> None:
    base = sphere(50, 3)  # not what float32 holds
    folders = [tmp_path / "first", tmp_path / "second"]
    for folder in folders:
        folder.mkdir()
    results = [run_graft(folder, base, sphere(49, 2), TOP, seam_mm=5) for folder in folders]
    for name in ("mesh", "report", "report_html"):
        assert results[0]["files"][name].read_bytes() == results[1]["files"][name].read_bytes()
    changes = json.loads(results[0]["files"]["report"].read_bytes())["changes"]
    assert "float32" in changes[0]["what"]


@pytest.mark.parametrize(
    ("base", "donor", "code", "name"),
    [
        (without_faces(sphere(50, 3), [0]), sphere(49, 3), "skin.not_closed", "base"),
        (sphere(50, 3), flipped(sphere(49, 3)), "skin.inside_out", "donor"),
        (sphere(50, 3), together(sphere(49, 3), sphere(5, 2, at=(200, 0, 0))), "skin.several_bodies", "donor"),
    ],
)
def test_unfit_meshes_are_refused_by_name(base: Mesh, donor: Mesh, code: str, name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=name) as refusal:
        run_graft(tmp_path, base, donor, TOP)
    assert refusal.value.code == code
    assert {output["name"] for output in refusal.value.outputs} == {"report", "report_html"}


def test_a_refused_region_leaves_a_report_with_the_places(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="up to 10 mm") as refusal:
        run_graft(tmp_path, sphere(50, 4), sphere(40, 4), TOP)
    assert refusal.value.code == "graft.too_far"
    report = json.loads((tmp_path / "report.json").read_bytes())
    assert report["verdict"] == "not_ready"
    assert report["findings"][0]["places"]


def test_what_is_not_proven_is_not_handed_out() -> None:
    broken = without_faces(sphere(10, 1), [0])
    validation = validate({"mesh": broken})
    report = Report(
        process="graft", verdict=validation.verdict, summary="", meshes=validation.meshes, findings=validation.findings
    )
    with pytest.raises(InternalError, match="not closed") as failure:
        _require_proven(report, broken, broken)
    assert failure.value.code == "graft.not_proven"
    two = together(sphere(10, 1), sphere(10, 1, at=(50, 0, 0)))
    validation = validate({"mesh": two})
    report = report.model_copy(update={"verdict": "simulation_ready", "meshes": validation.meshes, "findings": ()})
    with pytest.raises(InternalError, match="2 pieces"):
        _require_proven(report, two, two)
