"""`prepare`: a broken skin with an ear, a canal and three inner tissues becomes a model; refusals leave what was done."""

from __future__ import annotations

import hashlib
import json
from itertools import pairwise
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import meshio
import numpy as np
import pytest

from core.errors import InputError, IntegumentError
from core.geometry.exact_intersection import find_intersecting_faces
from core.io.registry import read_meshes
from core.mesh import Mesh
from core.package.read import read_package
from core.schema.prepare import PrepareInputs
from core.schema.report import Report
from core.tetrahedra.tetgen_ways import Way
from subjects.touching import closed_ring
from tests.core.processes.preparing import BRAIN, CANAL, EYE, SKIN, TIP, WHITE, Attempt, report_in
from tests.solids import flipped, sphere, together, without_faces

MESHES = {"skin": SKIN, "canal": CANAL, "brain": BRAIN, "white": WHITE, "eye": EYE}
ASKED: dict[str, Any] = {
    "ears": [TIP],
    "decimate": {"target_ratio": 0.8},
    "smooth": {"iterations": 2},
    "said": {"white": {"inside": "brain"}, "eye": {"conductivity_s_per_m": 1.5}},
}
STEPS = ["heal", "decimate", "detach", "smooth", "tissues", "ears", "layers", "separate", "validate", "tetrahedra"]


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Attempt:
    attempt = Attempt(tmp_path_factory.mktemp("prepare") / "first", MESHES, {}, **ASKED)
    attempt.result = attempt.run()  # type: ignore[attr-defined]
    return attempt


@pytest.fixture(scope="module")
def done(first: Attempt) -> dict[str, Any]:
    result: dict[str, Any] = first.result  # type: ignore[attr-defined]
    return result


@pytest.fixture(scope="module")
def report(first: Attempt) -> Report:
    return report_in(first.out)


def test_the_model_is_ready_and_exactly_clean(done: dict[str, Any], report: Report) -> None:
    assert done["verdict"] == report.verdict == "simulation_ready"
    package = read_package(done["files"]["package"])
    assert list(package.surfaces) == ["skin", "fat", "average_body", "brain", "white", "eye"]
    whole = together(*package.surfaces.values())
    assert len(find_intersecting_faces(whole.vertices, whole.faces)) == 0
    assert report.nesting["white"] == "brain"
    assert report.nesting["eye"] == report.nesting["brain"] == "average_body"
    conductivity = {tissue.name: tissue.conductivity_s_per_m for tissue in package.manifest.tissues}
    assert conductivity["eye"] == 1.5
    gaps = {frozenset((pair.a, pair.b)): pair.min_gap_mm for pair in report.pairs}
    assert min(gap for gap in gaps.values() if gap is not None) >= 0.05
    assert 0.1 <= (gaps[frozenset(("brain", "eye"))] or 0.0) < 0.15  # they crossed


def test_every_tissue_is_a_region_of_the_tetrahedra(done: dict[str, Any], report: Report) -> None:
    tags = meshio.read(done["files"]["msh"]).cell_data_dict["gmsh:physical"]["tetra"]
    assert {region.region_tag: region.tetrahedra for region in report.regions.values()} == {
        int(tag): int((tags == tag).sum()) for tag in np.unique(tags)
    }
    assert set(report.regions) == set(report.meshes)
    packed = {tissue.name: tissue.region_tag for tissue in read_package(done["files"]["package"]).manifest.tissues}
    assert packed == {name: region.region_tag for name, region in report.regions.items()}


def test_the_package_holds_the_tetrahedra(done: dict[str, Any]) -> None:
    with ZipFile(done["files"]["package"]) as archive:
        assert archive.read("gmsh/volume.msh") == done["files"]["msh"].read_bytes()
        assert "gmsh gmsh/volume.msh" in archive.read("README.txt").decode()
    listed = read_package(done["files"]["package"]).manifest.files["gmsh/volume.msh"]
    assert (listed.sha256, listed.bytes) == (_sha256(done["files"]["msh"]), done["files"]["msh"].stat().st_size)


def test_the_report_has_a_section_per_step(done: dict[str, Any], report: Report) -> None:
    assert [step.name for step in report.steps] == STEPS
    assert {step.name: step.outcome for step in report.steps} == {**dict.fromkeys(STEPS, "done"), "detach": "not_needed"}
    assert report.steps[7].numbers["tissues moved"] == 2
    heal = report.steps[0]
    assert (heal.numbers["faces before"], heal.numbers["faces after"]) == (2047, 2048)
    assert "holes" in heal.summary
    page = done["files"]["report_html"].read_text(encoding="utf-8")
    assert [name for name in STEPS if f'id="step-{name}"' not in page] == ["detach"]  # not needed: a line in the list alone
    assert report.methods.count("[1]") >= 1
    assert len(report.references) == len(set(report.references)) >= 4


def test_the_record_tells_what_every_step_took(done: dict[str, Any], first: Attempt) -> None:
    record = json.loads(done["files"]["steps"].read_bytes())["steps"]
    assert [step["name"] for step in record] == [*STEPS, "package"]
    by_name = {step["name"]: step for step in record}
    assert by_name.pop("detach")["seconds"] is None
    assert {step["outcome"] for step in by_name.values()} == {"done"}
    assert all(step["seconds"] >= 0 and not step["taken_from_attempt_before"] for step in by_name.values())
    assert by_name["heal"]["faces_before"] == {"skin": 2047}
    assert by_name["heal"]["faces_after"] == {"skin": 2048}
    assert set(by_name["layers"]["faces_after"]) == {"skin", "fat", "average_body", "brain", "white", "eye"}
    assert [line for line in first.log if line.startswith("step heal done")]


def test_an_attempt_after_a_crash_does_nothing_twice(first: Attempt, done: dict[str, Any], tmp_path: Path) -> None:
    again = Attempt(tmp_path / "again", MESHES, first.kept(), **ASKED)
    result = again.run()
    assert again.made == {}
    record = json.loads(result["files"]["steps"].read_bytes())["steps"]
    assert {step["name"] for step in record if step["taken_from_attempt_before"]} == set(STEPS) - {"detach"}
    for name in set(result["files"]) - {"steps"}:  # its seconds are those of the attempt
        assert _sha256(result["files"][name]) == _sha256(done["files"][name]), name


def test_after_every_step_there_is_what_a_killed_job_leaves(first: Attempt, done: dict[str, Any]) -> None:
    names = [set(left) - {"steps"} for left in first.left]
    assert names[0] == {"skin"}  # healed
    assert names[-1] == {"skin", "fat", "average_body", "brain", "white", "eye"}
    assert all(before <= after for before, after in pairwise(names))
    for name, path in first.left[-1].items():
        if name != "steps":  # the same surfaces as in the package
            assert path.read_bytes() == done["files"][name].read_bytes()
    assert [path.name for path in (first.out / "left").iterdir() if path.suffix not in (".stl", ".json")] == []


def test_a_failing_step_leaves_the_results_before_it(first: Attempt, tmp_path: Path) -> None:
    attempt = Attempt(tmp_path / "cross", MESHES, first.kept(), separate=None, **ASKED)
    with pytest.raises(InputError) as caught:
        attempt.run()
    error = caught.value
    assert error.code == "tissues.cross"
    assert {place.mesh for finding in error.findings for place in finding.places} == {"brain", "eye"}
    left = {output["name"]: Path(output["path"]) for output in error.outputs}
    assert set(left) == {"skin", "fat", "average_body", "brain", "white", "eye", "steps", "report", "report_html"}
    fat = read_meshes(left["fat"], file_name="fat.stl", unit="mm").meshes[0].mesh
    assert len(find_intersecting_faces(fat.vertices, fat.faces)) == 0
    report = report_in(attempt.out)
    outcomes = {step.name: step.outcome for step in report.steps}
    ended = {"detach": "not_needed", "separate": "not_needed", "validate": "failed", "tetrahedra": "not_reached"}
    assert outcomes == {**dict.fromkeys(STEPS[:7], "done"), **ended}
    record = {step["name"]: step for step in json.loads(left["steps"].read_bytes())["steps"]}
    assert record["layers"]["taken_from_attempt_before"]
    assert record["validate"]["outcome"] == "failed"
    assert "figure-heal_" in left["report_html"].read_text(encoding="utf-8")


def test_every_step_may_be_left_out(tmp_path: Path) -> None:
    attempt = Attempt(tmp_path / "bare", {"skin": sphere(50.0, 2)}, heal=None, tetrahedra=None)
    result = attempt.run()
    assert set(result["files"]) == {"package", "skin", "fat", "average_body", "steps", "report", "report_html"}
    outcomes = {step.name: step.outcome for step in report_in(attempt.out).steps}
    assert {name for name, outcome in outcomes.items() if outcome == "done"} == {"layers", "validate"}
    assert {name for name, outcome in outcomes.items() if outcome == "not_needed"} == set(STEPS) - {"layers", "validate"}


def test_gmsh_fills_what_tetgen_gives_up_on_and_the_report_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("core.tetrahedra.tetgen_ways.WAYS", (Way(0.5),))  # whole balls are flat to it
    attempt = Attempt(tmp_path / "gmsh", {"skin": sphere(50.0, 2)})
    assert attempt.run()["verdict"] == "simulation_ready"
    report = report_in(attempt.out)
    assert "tetrahedra.by_gmsh" in [finding.code for finding in report.findings]
    assert "gmsh" in report.software
    assert "tetgen" not in report.software
    step = next(step for step in report.steps if step.name == "tetrahedra")
    assert "by gmsh" in step.methods


def test_parts_that_touch_are_set_apart_first(tmp_path: Path) -> None:
    ring = closed_ring(4.0)
    box = {"name": "ends", "box_mm": {"min": [20.0, -25.0, -15.0], "max": [60.0, 25.0, 15.0]}}
    asked = {"layers": [{"name": "fat", "depth_mm": 1.0}], "tetrahedra": None}
    attempt = Attempt(tmp_path / "ring", {"skin": ring}, detach={"regions": [box], "gap_mm": 1.0}, **asked)
    assert attempt.run()["verdict"] == "simulation_ready"
    report = report_in(attempt.out)
    (step,) = (step for step in report.steps if step.name == "detach")
    assert (step.numbers["genus before"], step.numbers["genus after"]) == (1, 0)
    assert report.meshes["fat"].genus == 0


BALL = sphere(50.0, 2)
REFUSALS: dict[str, tuple[dict[str, Mesh], dict[str, Any]]] = {
    "skin.not_closed": ({"skin": without_faces(BALL, [3])}, {"heal": None}),
    "tissues.outside_skin": ({"skin": BALL, "organ": sphere(10.0, 2, at=(60.0, 0.0, 0.0))}, {}),
    "tissues.outside_layers": ({"skin": BALL, "speck": sphere(0.2, 1, at=(0.0, 0.0, 48.4))}, {}),
    "tissues.too_close": (
        {"skin": BALL, "one": sphere(10.0, 2), "other": sphere(10.0, 2, at=(20.02, 0.0, 0.0))},
        {"min_gap_mm": 0.5, "separate": None},
    ),
    "tissues.not_nested": (
        {"skin": BALL, "brain": BRAIN, "white": WHITE},
        {"said": {"brain": {"inside": "white"}}, "separate": None},
    ),
    "separate.not_inside": ({"skin": BALL, "brain": BRAIN, "white": WHITE}, {"said": {"brain": {"inside": "white"}}}),
    "surface.not_closed": ({"skin": BALL, "organ": without_faces(WHITE, [2])}, {}),
    "surface.inside_out": ({"skin": BALL, "organ": flipped(WHITE)}, {}),
    "tetrahedra.unknown_tissue": ({"skin": BALL}, {"tetrahedra": {"max_volume_mm3": {"bone": 1.0}}}),
}


@pytest.mark.parametrize("code", REFUSALS)
def test_unfit_input_is_refused_by_name(tmp_path: Path, code: str) -> None:
    meshes, asked = REFUSALS[code]
    with pytest.raises(IntegumentError) as caught:
        Attempt(tmp_path, meshes, tetrahedra=asked.pop("tetrahedra", None), **asked).run()
    assert isinstance(caught.value, InputError)
    assert caught.value.code == code
    assert {"report", "report_html", "steps"} <= {output["name"] for output in caught.value.outputs}


def test_smoothing_is_bound_unless_asked_otherwise() -> None:
    bound = PrepareInputs.model_validate({"skin": LINK, "smooth": {}}).as_smooth()
    assert (bound.max_shift_mm, bound.retriangulate) == (0.5, True)
    sent = PrepareInputs.model_validate({"skin": LINK, "smooth": {"max_shift_mm": None}}).model_dump(mode="json")
    assert PrepareInputs.model_validate(sent).as_smooth().max_shift_mm is None


LINK = {"href": f"/v1/meshes/{'0' * 36}"}


@pytest.mark.parametrize(
    ("inputs", "words"),
    [
        ({"canals": [LINK]}, "go with `ears`"),
        ({"generate_canals": {}}, "go with `ears`"),
        ({"ears": [TIP], "ear_depths_mm": {"fat": 4.0}}, "must increase inwards"),
        ({"decimate": {}}, "exactly one of"),
        ({"decimate": {"target_ratio": 0.5, "target_faces": 9}}, "exactly one of"),
        ({"tissues": [{"name": "Fat", "mesh": LINK}]}, "must differ"),
        ({"tissues": [{"name": "steps", "mesh": LINK}]}, "must differ"),
        ({"layers": [{"name": "msh", "depth_mm": 1}]}, "must differ"),
        ({"tissues": [{"name": "heart", "mesh": LINK, "inside": "chest"}]}, "to be inside 'chest'"),
        ({"separate": {"priority": {"skin": 1}}}, "priority names"),
        ({"detach": {"regions": [TIP], "pieces": 2}}, "pieces must be 1"),
        ({"layers": [{"name": "deep", "depth_mm": 3}, {"name": "fat", "depth_mm": 1}]}, "must increase inwards"),
    ],
)
def test_requests_that_contradict_themselves_are_refused(inputs: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        PrepareInputs.model_validate({"skin": LINK, **inputs})


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
