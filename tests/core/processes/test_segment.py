"""`segment` as a process, from the bytes of an upload to package and report."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.errors import InputError
from core.io.canonical_volume import load_volume
from core.package.read import read_package
from core.processes import intake
from core.schema.report import Report
from tests.core.io.nifti_bytes import nifti, packed, two_boxes
from tests.core.processes.test_surface_processes import executed, href
from tests.core.segmentation.labelled_solids import centred, oblique, spheres

AFFINE = centred(9.0, (1.2, 1.0, 1.4), oblique())


def taken_in(folder: Path, data: bytes, file_name: str = "head.nii.gz") -> dict[str, Any]:
    (folder / "upload").write_bytes(data)
    return intake.run(
        {"path": str(folder / "upload"), "file_name": file_name, "unit": "mm", "out_dir": str(folder)}, channel=None
    )


def entries(told: dict[str, Any]) -> dict[str, dict[str, Any]]:
    (mesh,) = told["meshes"]
    return {href(0): {"path": mesh["path"], "name": mesh["name"], "sha256": "0" * 64}}


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("segment")
    labels = np.array(spheres((9.0, 6.0), AFFINE).labels)
    labels[1, 1, 1] = 2  # a speck far from the head
    told = taken_in(folder, packed(nifti(labels, AFFINE)))
    inputs = {"volume": {"href": href(0)}, "names": {"1": "skin", "2": "white_matter"}}
    return {**executed("segment", folder, inputs, entries(told)), "told": told}


def test_the_intake_tells_voxels_and_labels(done: dict[str, Any]) -> None:
    told = done["told"]
    assert (told["format"], told["meshes"][0]["name"], told["meshes"][0]["faces"]) == ("nifti", "head", 0)
    assert told["volume"]["voxel_mm"] == pytest.approx([1.2, 1.0, 1.4], rel=1e-6)
    assert [row["label"] for row in told["volume"]["labels"]] == [1, 2]
    assert told["volume"]["labels"][1]["volume_mm3"] == pytest.approx(4 / 3 * np.pi * 6.0**3, rel=0.02)
    assert load_volume(Path(told["meshes"][0]["path"])).labels.shape == tuple(told["volume"]["voxels"])


def test_the_package_holds_nested_tissues(done: dict[str, Any]) -> None:
    assert done["verdict"] == "simulation_ready"
    assert set(done["files"]) == {"package", "skin", "white_matter", "report", "report_html"}
    package = read_package(done["files"]["package"])
    assert {tissue.name: tissue.enclosing_tissue for tissue in package.manifest.tissues} == {
        "skin": "FreeSpace",
        "white_matter": "skin",
    }
    assert {tissue.name: tissue.conductivity_s_per_m for tissue in package.manifest.tissues}["white_matter"] == 0.126


def test_the_report_accounts_for_every_voxel(done: dict[str, Any]) -> None:
    report = done["report"]
    skin, white = report.changes
    counts = {row["label"]: row["voxels"] for row in done["told"]["volume"]["labels"]}
    assert skin["voxels"] == counts[1]
    assert skin["cavity_voxels_filled"] == white["voxels"] == counts[2] - 1
    assert (white["island_voxels_dropped"], white["islands_dropped"]) == (1, 1)
    assert [finding.code for finding in report.findings] == ["segment.islands_dropped"]
    assert "0 intersecting pairs" in report.summary
    assert "white_matter" in done["files"]["report_html"].read_text(encoding="utf-8")


def test_the_same_volume_gives_the_same_package(done: dict[str, Any], tmp_path: Path) -> None:
    again = executed(
        "segment",
        tmp_path,
        {"volume": {"href": href(0)}, "names": {"1": "skin", "2": "white_matter"}},
        entries(done["told"]),
    )
    assert again["files"]["package"].read_bytes() == done["files"]["package"].read_bytes()


def test_a_label_cut_off_by_the_volume_is_told(tmp_path: Path) -> None:
    labels = np.zeros((9, 9, 9), dtype=np.uint8)
    labels[2:7, 2:7, 4:] = 3
    told = taken_in(tmp_path, nifti(labels, np.diag([4.0, 4.0, 4.0, 1.0])), "block.nii")
    result = executed("segment", tmp_path, {"volume": {"href": href(0)}}, entries(told))
    (finding,) = result["report"].findings
    assert (finding.code, finding.count) == ("segment.cut_off", 25)
    assert result["report"].meshes["label_3"].volume_mm3 == pytest.approx(125 * 64.0, rel=0.03)


def test_a_refusal_leaves_a_report(tmp_path: Path) -> None:
    told = taken_in(tmp_path, nifti(two_boxes(), np.diag([8.0, 8.0, 8.0, 1.0])), "boxes.nii")
    with pytest.raises(InputError) as error:
        executed("segment", tmp_path, {"volume": {"href": href(0)}, "names": {"4": "bone"}}, entries(told))
    assert error.value.code == "segment.label_missing"
    assert {output["name"] for output in error.value.outputs} == {"report", "report_html"}


def test_what_is_called_nifti_and_is_none_is_refused_as_such(tmp_path: Path) -> None:
    with pytest.raises(InputError) as error:
        taken_in(tmp_path, b"solid but not really" * 30, "labels.nii")
    assert error.value.code == "nifti.header"


def test_a_refused_request_shows_what_the_volume_holds(tmp_path: Path) -> None:
    told = taken_in(tmp_path, packed(nifti(np.array(spheres((9.0, 6.0), AFFINE).labels), AFFINE)))
    with pytest.raises(InputError) as refused:
        executed("segment", tmp_path, {"volume": {"href": href(0)}, "names": {"1": "skin", "7": "bone"}}, entries(told))
    assert refused.value.code == "segment.label_missing"
    report = Report.model_validate_json((tmp_path / "out" / "report.json").read_bytes())
    assert report.failure is not None
    assert report.failure.code == "segment.label_missing"
    volume = report.parameters["volume"]
    assert list(volume["labels"]) == ["1", "2"]
    assert volume["voxel_mm"] == [1.2, 1.0, 1.4]
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert 'Refused: <span class="reason">no voxel has the label 7' in page
    assert "volume.labels.2" in page
