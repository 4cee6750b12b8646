"""The process `detach`: report, picture, file and findings of contacts known by formula."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from core.io import canonical
from core.io.registry import read_meshes
from core.mesh import Mesh
from core.processes.registry import run
from core.schema.report import Report
from subjects.touching import balls_grown_together, closed_ring

SKIN = "/v1/meshes/00000000-0000-0000-0000-000000000001"
BOX = {"min": [20, -30, -15], "max": [60, 30, 15]}


class Silent:
    """Takes events."""

    def send(self, message: dict[str, Any]) -> None:
        """Nobody listens."""


def run_detach(folder: Path, mesh: Mesh, box: dict[str, Any], **inputs: Any) -> dict[str, Any]:
    """The result of the registry; its paths by the names of outputs."""
    path = folder / "skin.mesh"
    canonical.save(mesh, path)
    meshes = {SKIN: {"path": str(path), "name": "person", "sha256": "0" * 64}}
    asked = {"skin": {"href": SKIN}, "regions": [{"name": "contact", "box_mm": box}], **inputs}
    result = run({"process": "detach", "inputs": asked, "meshes": meshes, "out_dir": str(folder)}, Silent())
    return {**result, "files": {output["name"]: Path(output["path"]) for output in result["outputs"]}}


def test_a_ring_is_opened_and_the_report_says_how(tmp_path: Path) -> None:
    mesh = closed_ring(4.0)
    result = run_detach(tmp_path, mesh, BOX, gap_mm=0.8)
    assert result["verdict"] == "simulation_ready"
    report = Report.model_validate(json.loads(result["files"]["report"].read_text()))
    delivered = read_meshes(result["files"]["skin"], file_name="skin.stl", unit="mm").meshes[0].mesh
    assert report.meshes["skin"].genus == 0
    assert report.meshes["skin"].self_intersecting_pairs == 0
    assert report.meshes["skin"].faces == len(delivered.faces)
    (change,) = report.changes
    assert 0.8 <= change["gap_mm"] <= change["mean_gap_mm"]
    assert (change["genus_before"], change["genus_after"]) == (1, 0)
    assert change["area_mm2"] == pytest.approx(36 * np.pi, rel=0.08)
    assert change["volume_mm3"] > 0.8 * 0.9 * 36 * np.pi
    assert [finding.code for finding in report.findings if finding.code.startswith("detach.")] == ["detach.opened"]
    assert "Contacts before and after" in result["files"]["report_html"].read_text()
    assert "at least" in report.summary
    assert "1 piece." in report.summary


def test_a_slit_that_ends_in_the_body_is_a_warning_with_its_place(tmp_path: Path) -> None:
    result = run_detach(tmp_path, balls_grown_together(30.0, 50.0), {"min": [-40, -40, 3], "max": [90, 40, 40]})
    report = Report.model_validate(json.loads(result["files"]["report"].read_text()))
    (ending,) = [finding for finding in report.findings if finding.code == "detach.ends_in_body"]
    assert ending.severity == "warning"
    assert abs(ending.places[0].point_mm[0] - 25.0) < 3.0


def test_a_refusal_leaves_a_report_with_the_place(tmp_path: Path) -> None:
    with pytest.raises(InputError) as refused:
        run_detach(tmp_path, balls_grown_together(30.0, 50.0), {"min": [-40, -40, -40], "max": [90, 40, 40]})
    assert refused.value.code == "detach.region_cuts_too_much"
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["verdict"] == "not_ready"
    assert report["findings"][0]["places"]
