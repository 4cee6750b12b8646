"""The process `ears` on the real body: the thesis' case, from the request to the files; unfit input."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from core.ears.canal import make_canal
from core.errors import InputError, IntegumentError
from core.geometry.distance import closest_points
from core.geometry.exact_intersection import find_intersecting_faces
from core.io import canonical
from core.mesh import Mesh
from core.package.read import read_shells
from core.processes.registry import run
from core.schema.ears import EarsInputs
from core.schema.report import Report
from subjects.body import body
from tests.solids import cube, sphere, together, without_faces

SKIN, CANAL = (f"/v1/meshes/00000000-0000-0000-0000-00000000000{digit}" for digit in "12")
BALL = sphere(50.0, 4)
TIP = {"name": "tip", "box_mm": {"min": [40, -20, -20], "max": [60, 20, 20]}}


class Silent:
    """Takes events."""

    def send(self, message: dict[str, Any]) -> None:
        """Nobody waits."""


def run_ears(
    folder: Path, skin: Mesh, canal: Mesh | None = None, arrays: Mapping[str, Any] | None = None, **inputs: Any
) -> dict[str, Any]:
    """The result of the registry; `files` are its paths by the names of outputs."""
    meshes = {}
    for href, name, mesh in ((SKIN, "body", skin), (CANAL, "left canal", canal)):
        if mesh is not None:
            canonical.save(mesh, folder / f"{name}.mesh", arrays if href == SKIN else None)
            meshes[href] = {"path": str(folder / f"{name}.mesh"), "name": name, "sha256": "0" * 64}
    asked = {"skin": {"href": SKIN}, **({} if canal is None else {"canals": [{"href": CANAL}]}), **inputs}
    result = run({"process": "ears", "inputs": asked, "meshes": meshes, "out_dir": str(folder)}, Silent())
    return {**result, "files": {output["name"]: Path(output["path"]) for output in result["outputs"]}}


@pytest.fixture(scope="module")
def thesis(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Both ears found, a generated canal in each."""
    return run_ears(tmp_path_factory.mktemp("ears"), body(0), generate_canals={})


@pytest.fixture(scope="module")
def report(thesis: dict[str, Any]) -> Report:
    return Report.model_validate_json(thesis["files"]["report"].read_bytes())


@pytest.fixture(scope="module")
def shells(thesis: dict[str, Any]) -> dict[str, Mesh]:
    return read_shells(thesis["files"]["package"])


def test_the_package_is_ready_and_exactly_clean(thesis: dict[str, Any], report: Report, shells: Mapping[str, Mesh]) -> None:
    assert thesis["verdict"] == report.verdict == "simulation_ready"
    assert list(shells) == ["skin", "fat", "average_body"]
    whole = together(*shells.values())
    assert len(find_intersecting_faces(whole.vertices, whole.faces)) == 0
    assert report.nesting == {"skin": None, "fat": "skin", "average_body": "fat"}
    assert min(pair.min_gap_mm for pair in report.pairs if pair.min_gap_mm is not None) >= 0.05
    assert set(thesis["files"]) == {"package", "skin", "fat", "average_body", "report", "report_html"}


@pytest.mark.parametrize(
    ("layer", "ear_mm", "elsewhere_mm", "share"), [("fat", 0.3, 1.0, 0.85), ("average_body", 0.6, 3.0, 0.95)]
)
def test_depths_are_the_thesis_ones(
    report: Report, shells: Mapping[str, Mesh], layer: str, ear_mm: float, elsewhere_mm: float, share: float
) -> None:
    points = shells[layer].vertices
    depth, _, _ = closest_points(shells["skin"].vertices, shells["skin"].faces, points)
    in_ears = np.zeros(len(points), dtype=bool)
    for region in report.parameters["regions"]:
        inside = ((points >= region["box_mm"]["min"]) & (points <= region["box_mm"]["max"])).all(axis=1)
        assert (np.abs(depth[inside] - ear_mm) <= 0.05 * ear_mm).mean() >= share, region["name"]
        in_ears |= inside
    assert in_ears.sum() > 1000
    torso = np.abs(points[:, 1] - 300.0) < 100.0
    assert (np.abs(depth[torso] - elsewhere_mm) <= 0.05 * elsewhere_mm).mean() >= 0.95


def test_the_report_names_the_boxes_and_what_was_changed(thesis: dict[str, Any], report: Report) -> None:
    regions = {region["name"]: region for region in report.parameters["regions"]}
    assert list(regions) == ["left_ear", "right_ear", "left_ear_canal", "right_ear_canal"]
    again = {"skin": {"href": SKIN}, "ears": report.parameters["regions"]}
    assert EarsInputs.model_validate(again).ears[0].name == "left_ear"  # ready to be sent again
    assert regions["left_ear"]["depths_mm"] == {"fat": 0.3, "average_body": 0.6}
    # the wall of the canal runs 25 mm inwards from the concha
    assert regions["left_ear_canal"]["box_mm"]["min"][0] < 45 < 68 < regions["left_ear_canal"]["box_mm"]["max"][0]
    found = [finding for finding in report.findings if finding.code == "ears.region"]
    assert len(found) == 4
    assert "fat 0.3 mm on target on" in found[0].message
    cut = next(change for change in report.changes if "canals cut out" in change["what"])
    assert cut["lowest_quality_of_new_faces"] >= 0.1
    assert cut["farthest_from_given_surfaces_mm"] < 0.25
    page = thesis["files"]["report_html"].read_text(encoding="utf-8")
    assert "<h2" in page
    assert "The boxes in which the ears" in page
    assert "walls of the canals" in page


def test_given_boxes_and_a_sent_canal(tmp_path: Path) -> None:
    canal = Mesh.of(cube(1.0).vertices * (20.0, 8.0, 8.0) + (35.0, -4.0, -4.0), cube(1.0).faces)
    ears = [{**TIP, "depths_mm": {"fat": 0.5}, "blend_mm": 2.0}]
    result = run_ears(tmp_path, BALL, canal, ears=ears)
    assert result["verdict"] == "simulation_ready"
    report = Report.model_validate_json(result["files"]["report"].read_bytes())
    tip, wall = report.parameters["regions"]
    assert tip["depths_mm"] == wall["depths_mm"] == {"fat": 0.5}
    assert wall["name"] == "left_canal"
    assert wall["box_mm"]["min"][0] == pytest.approx(34.5, abs=0.11)
    assert report.meshes["skin"].quality.minimum > 0.05


REFUSALS = {
    "ears.not_found": (BALL, None, {}),
    "canal.not_closed": (BALL, without_faces(sphere(5.0, 2, at=(50, 0, 0)), [3]), {"ears": [TIP]}),
    "canal.misses_skin": (BALL, sphere(5.0, 2, at=(70, 0, 0)), {"ears": [TIP]}),
    "canal.splits_skin": (BALL, sphere(5.0, 2), {"ears": [TIP]}),
    "region.outside_mesh": (BALL, None, {"ears": [{"name": "far", "box_mm": {"min": [90, 0, 0], "max": [95, 1, 1]}}]}),
    "region.overlap_conflict": (BALL, None, {"ears": [TIP], "regions": [{**TIP, "name": "other", "depths_mm": {"fat": 0.7}}]}),
    "skin.not_closed": (without_faces(BALL, [7]), None, {"ears": [TIP]}),
}


@pytest.mark.parametrize("code", REFUSALS)
def test_unfit_input_is_refused_by_name_with_a_report(tmp_path: Path, code: str) -> None:
    skin, canal, inputs = REFUSALS[code]
    with pytest.raises(IntegumentError) as caught:
        run_ears(tmp_path, skin, canal, **inputs)
    assert isinstance(caught.value, InputError)
    assert caught.value.code == code
    assert {output["name"] for output in caught.value.outputs} == {"report", "report_html"}


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({"ear_depths_mm": {"muscle": 0.5}}, "layers that do not exist"),
        ({"ear_depths_mm": {"fat": 4.0}}, "must increase inwards"),
        ({"ears": [{**TIP, "depths_mm": {"average_body": 0.5}}]}, "must increase inwards"),
        ({"ears": [TIP], "generate_canals": {}}, "goes with ears 'auto'"),
        ({"canals": [{"href": CANAL}], "generate_canals": {}}, "without canals"),
        ({"ears": "both"}, "auto"),
        ({"layers": [{"name": "fat", "depth_mm": 1}, {"name": "Fat", "depth_mm": 2}]}, "differ"),
    ],
)
def test_requests_that_contradict_themselves_are_refused(inputs: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        EarsInputs.model_validate({"skin": {"href": SKIN}, **inputs})


def test_arrays_outer_layers_and_a_moved_skin_go_with_ears_and_canals(tmp_path: Path) -> None:
    slope = 2.0 + BALL.vertices[:, 2] / 50.0
    canal = make_canal((49.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 0.0, 1.0)).rounded_to_float32()
    layers = [{"name": "gel", "depth_mm": 1.5, "side": "outside"}, {"name": "fat", "depth_array": "fat_mm"}]
    done = run_ears(
        tmp_path, BALL, canal, {"fat_mm": slope}, ears=[TIP], layers=layers, ear_depths_mm={"fat": 0.5}, skin_shift_mm=0.5
    )
    assert done["verdict"] == "simulation_ready"
    shells = read_shells(done["files"]["package"])
    assert list(shells) == ["gel", "skin", "fat"]
    points = shells["fat"].vertices
    depth = closest_points(shells["skin"].vertices, shells["skin"].faces, points)[0]
    far = points[:, 0] < 20
    wanted = 2.0 + 50.0 / np.linalg.norm(points[far], axis=1) * points[far][:, 2] / 50.0
    assert depth[far] == pytest.approx(wanted, rel=0.05)
    wall = (np.abs(points[:, 1:]) < 5).all(axis=1) & (points[:, 0] > 30) & (points[:, 0] < 45)
    assert np.median(depth[wall]) == pytest.approx(0.5, rel=0.05)
    around = closest_points(shells["skin"].vertices, shells["skin"].faces, shells["gel"].vertices)[0]
    assert around[shells["gel"].vertices[:, 0] < 20] == pytest.approx(1.5, rel=0.05)
