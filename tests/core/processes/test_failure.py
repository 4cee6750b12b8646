"""The report of a failed job tells as much as that of a good one."""

import json
from pathlib import Path
from typing import Any

import pytest

from core.errors import IntegumentError
from core.io import canonical
from core.mesh import Mesh
from core.processes.registry import run
from core.schema.report import Report
from tests.solids import flipped, sphere, without_faces

HREF = "/v1/meshes/00000000-0000-0000-0000-000000000001"


class Silent:
    def send(self, message: dict[str, Any]) -> None:
        del message


def fail(folder: Path, mesh: Mesh, process: str = "shells", **inputs: Any) -> tuple[IntegumentError, Report, str]:
    out = folder / "out"
    out.mkdir()
    canonical.save(mesh, folder / "0.mesh")
    payload = {
        "process": process,
        "inputs": {"skin": {"href": HREF}, **inputs},
        "meshes": {HREF: {"path": str(folder / "0.mesh"), "name": "torso", "sha256": "ab" * 32}},
        "out_dir": str(out),
    }
    with pytest.raises(IntegumentError) as caught:
        run(payload, Silent())
    assert [output["name"] for output in caught.value.outputs] == ["report", "report_html"]
    report = Report.model_validate_json((out / "report.json").read_bytes())
    return caught.value, report, (out / "report.html").read_text(encoding="utf-8")


def test_a_skin_with_faults_is_measured_drawn_and_shown_in_3d(tmp_path: Path) -> None:
    broken = flipped(without_faces(sphere(30.0, 3), [0, 1, 7]), [200])
    error, report, html = fail(tmp_path, broken)
    assert report.verdict == "not_ready"
    assert report.summary == error.message
    assert report.meshes["skin"].faces == len(broken.faces)
    assert not report.meshes["skin"].closed
    codes = [finding.code for finding in report.findings]
    assert "mesh.not_closed" in codes
    assert len(codes) > 1  # the turned face is told, too, though the job stopped at the hole
    assert len(set(codes)) == len(codes)
    assert report.parameters["sha256"] == {"torso": "ab" * 32}
    assert HREF not in html
    assert "Nothing was made." in report.methods
    for part in ('id="figure-surface"', 'id="figure-sections"', 'id="scene-data"', "data-at="):
        assert part in html


def test_a_request_that_cannot_be_met_shows_the_body_it_was_made_of(tmp_path: Path) -> None:
    error, report, html = fail(tmp_path, sphere(3.0, 3), layers=[{"name": "fat", "depth_mm": 5.0}])
    assert error.code == "layer.deeper_than_reach"
    assert report.findings[0].code == error.code
    assert report.meshes["skin"].closed
    assert json.loads(html.split('id="scene-about">')[1].split("</script>")[0])["surfaces"][0]["name"] == "skin"


def test_methods_claim_nothing_that_was_not_done(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    hrefs = [f"/v1/meshes/00000000-0000-0000-0000-00000000000{number}" for number in (1, 2)]
    for number, href in enumerate(hrefs):
        canonical.save(sphere(30.0, 2, at=(30.0 * number, 0.0, 0.0)), tmp_path / f"{href[-1]}.mesh")
    payload = {
        "process": "tetrahedralize",
        "inputs": {"meshes": {"a": {"href": hrefs[0]}, "b": {"href": hrefs[1]}}},
        "meshes": {href: {"path": str(tmp_path / f"{href[-1]}.mesh"), "name": href[-1], "sha256": "ab" * 32} for href in hrefs},
        "out_dir": str(out),
    }
    with pytest.raises(IntegumentError) as caught:
        run(payload, Silent())
    assert caught.value.code == "tetrahedra.surfaces_unfit"
    report = Report.model_validate_json((out / "report.json").read_bytes())
    assert report.methods.startswith("Nothing was made.")
    assert "tetrahedra" not in report.methods
    assert report.references
