"""What `integument heal`, `decimate`, `smooth`, `separate` and `tetrahedralize` send, and what comes back."""

import json
import zipfile
from hashlib import sha256
from pathlib import Path
from typing import Any

import pytest
from integument import ArgumentError, Client, Output
from integument.cli import main

from tests.client.faulty_server import JOB_ID, State

PACKAGE = f"/v1/jobs/{JOB_ID}/results/package"


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lab: tuple[str, State]) -> dict[str, str]:
    monkeypatch.setenv("INTEGUMENT_URL", lab[0])
    paths = {name: tmp_path / f"{name}.stl" for name in ("skin", "fat")}
    for path in paths.values():
        path.write_bytes(b"solid")
    return {name: str(path) for name, path in paths.items()}


def package(path: Path, **changed: Any) -> str:
    """A zip with two surfaces; `changed` are keys of the manifest's last tissue."""
    tissues = [{"name": name, "file": f"stl/{name}.stl", "sha256": sha256(name.encode()).hexdigest()} for name in ("skin", "fat")]
    tissues[1] |= changed
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("manifest.json", json.dumps({"tissues": tissues}))
        for name in ("skin", "fat"):
            archive.writestr(f"stl/{name}.stl", name)
    return str(path)


def will_end(state: State) -> None:
    state.events = [(1, "done", {"status": "successful"})]
    add = state.add_job
    state.add_job = lambda *_a, **k: add("successful", verdict="simulation_ready", **k)  # type: ignore[method-assign]


def sent(state: State, process: str, *arguments: str) -> dict[str, Any]:
    """The inputs of the job that the command makes."""
    will_end(state)
    assert main([process, *arguments]) == 0
    return inputs_of(state, process)


def inputs_of(state: State, process: str) -> dict[str, Any]:
    inputs: dict[str, Any] = json.loads(state.requests("POST", f"/v1/processes/{process}/execution")[0].body)["inputs"]
    return inputs


def test_decimate_sends_targets_and_regions_as_typed(state: State, files: dict[str, str]) -> None:
    region = "face:-80,600,0:80,800,150:1"
    inputs = sent(state, "decimate", files["skin"], "--ratio", "0.25", "--region", region, "--method", "quadric")
    assert set(inputs) == {"mesh", "target_ratio", "method", "regions"}
    assert (inputs["target_ratio"], inputs["method"]) == (0.25, "quadric")
    assert inputs["regions"] == [
        {"name": "face", "box_mm": {"min": [-80.0, 600.0, 0.0], "max": [80.0, 800.0, 150.0]}, "ratio": 1.0}
    ]


def test_smooth_and_heal_leave_defaults_to_the_server(state: State, files: dict[str, str]) -> None:
    assert set(sent(state, "heal", files["skin"])) == {"mesh"}


def test_options_of_heal(state: State, files: dict[str, str]) -> None:
    inputs = sent(state, "heal", files["skin"], "--no-fill-holes", "--pieces", "keep_all", "--max-deviation", "2", "--staircase")
    del inputs["mesh"]
    assert inputs == {"fill_holes": False, "pieces": "keep_all", "max_deviation_mm": 2.0, "staircase": True}


def test_options_of_separate(state: State, files: dict[str, str]) -> None:
    options = ["--fixed", "skin", "--priority", "fat=-2", "--inside", "fat=skin", "--inside", "skin=", "--min-gap", "0.2"]
    inputs = sent(state, "separate", files["skin"], files["fat"], "--max-shift", "1.5", *options)
    assert set(inputs.pop("meshes")) == {"skin", "fat"}
    assert inputs == {
        "fixed": ["skin"],
        "priority": {"fat": -2},
        "inside": {"fat": "skin", "skin": None},
        "min_gap_mm": 0.2,
        "max_shift_mm": 1.5,
    }


@pytest.mark.parametrize("option", [("--priority", "fat=high"), ("--inside", "fat")])
def test_what_separate_does_not_understand_is_not_sent(state: State, files: dict[str, str], option: tuple[str, str]) -> None:
    assert main(["separate", files["skin"], files["fat"], *option]) == 2
    assert not state.requests("POST", "/v1/processes/separate/execution")


def test_options_of_tetrahedralize(state: State, files: dict[str, str]) -> None:
    inputs = sent(
        state,
        "tetrahedralize",
        PACKAGE,
        "--mesher",
        "tetgen",
        "--radius-edge",
        "0",
        "--max-volume",
        "fat=2.5",
        "--max-volume",
        "skin=1",
    )
    assert inputs == {
        "package": {"href": PACKAGE},
        "mesher": "tetgen",
        "radius_edge": None,
        "max_volume_mm3": {"fat": 2.5, "skin": 1.0},
    }


def test_options_of_smooth(state: State, files: dict[str, str]) -> None:
    inputs = sent(state, "smooth", files["skin"], "--method", "wcc", "--iterations", "9", "--region", "a:0,0,0:1,1,1")
    del inputs["mesh"]
    box = {"min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 1.0]}
    assert inputs == {"method": "wcc", "iterations": 9, "regions": [{"name": "a", "box_mm": box}]}


def test_several_meshes_are_a_set_with_a_package_to_fetch(state: State, files: dict[str, str], tmp_path: Path) -> None:
    state.files[PACKAGE] = b"zip"
    target = tmp_path / "thin.zip"
    inputs = sent(state, "decimate", files["skin"], files["fat"], "--faces", "5000", "-o", str(target))
    assert set(inputs["meshes"]) == {"skin", "fat"}
    assert target.read_bytes() == b"zip"


def test_a_package_of_a_job_is_sent_as_one(state: State, files: dict[str, str]) -> None:
    inputs = sent(state, "smooth", PACKAGE, "--min-gap", "0.1")
    assert inputs == {"package": {"href": PACKAGE}, "method": "hc", "min_gap_mm": 0.1}


def test_a_package_on_this_disk_is_sent_surface_by_surface(state: State, files: dict[str, str], tmp_path: Path) -> None:
    inputs = sent(state, "heal", package(tmp_path / "package.zip"), "--unit", "cm")
    assert list(inputs["meshes"]) == ["skin", "fat"]
    assert [upload["unit"] for upload in state.uploads] == [b"mm", b"mm"]  # packages are in mm, whatever is said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["decimate", "SKIN"], "exactly one of --ratio, --faces and --max-deviation"),
        (["decimate", "SKIN", "--ratio", "0.5", "--faces", "100"], "--ratio and --faces"),
        (["decimate", "SKIN", "--ratio", "0.5", "--region", "a:0,0,0:1,1,1"], "a:0,0,0:1,1,1"),
        (["decimate", "SKIN", "--ratio", "0.5", "--region", "a:0,0,0:1,1,1:half"], "'half' is no number"),
        (["smooth", "SKIN", "--method", "magic"], "magic"),
        (["heal", "nowhere.stl"], "nowhere.stl"),
        (["heal", "nowhere.zip"], "nowhere.zip"),
        (["heal", PACKAGE, "SKIN"], "alone"),
    ],
)
def test_what_is_mistyped_is_refused_before_anything_is_sent(
    state: State, files: dict[str, str], capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert main([files["skin"] if word == "SKIN" else word for word in arguments]) == 2
    assert words in capsys.readouterr().err
    assert not state.uploads
    assert not state.jobs


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"sha256": "0" * 64}, "not the one the manifest names"),
        ({"name": "../fat"}, "can name no file"),
        ({"file": "x"}, "no package"),
    ],
)
def test_a_zip_that_is_no_package_is_refused(
    state: State, files: dict[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str], changed: dict[str, Any], words: str
) -> None:
    assert main(["heal", package(tmp_path / "package.zip", **changed)]) == 2
    assert words in capsys.readouterr().err
    assert not state.jobs


def test_what_is_no_zip_is_refused(
    state: State, files: dict[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "package.zip").write_bytes(b"solid")
    assert main(["heal", str(tmp_path / "package.zip")]) == 2
    assert "is no package" in capsys.readouterr().err


def test_what_became_of_the_surface_is_shown(state: State, files: dict[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    numbers = {"vertices": 500, "faces": 1000, "self_intersecting_pairs": 0, "quality": {"minimum": 0.1}}
    before = {**numbers, "faces": 4000, "quality": {"minimum": 0.02}}
    comparison = {"before": before, "deviation": {"maximum_mm": 0.1234}, "volume_change": -0.00123}
    state.report = {"verdict": "simulation_ready", "meshes": {"mesh": numbers}, "comparisons": {"mesh": comparison}}
    sent(state, "decimate", files["skin"], "--ratio", "0.25")
    shown = capsys.readouterr().out
    assert "4,000 → 1,000" in shown
    assert "0.123" in shown
    assert "-0.123%" in shown


def test_the_library_sends_the_same(state: State, client: Client, tmp_path: Path) -> None:
    will_end(state)
    client.decimate(b"solid", ratio=0.5, regions={"face": ((0, 0, 0), (1, 1, 1), 1.0)}, smooth_weight=0.5)
    inputs = inputs_of(state, "decimate")
    assert set(inputs) == {"method", "target_ratio", "smooth_weight", "regions", "mesh"}
    assert inputs["regions"] == [{"name": "face", "box_mm": {"min": [0, 0, 0], "max": [1, 1, 1]}, "ratio": 1.0}]
    client.smooth(Output.read({"href": PACKAGE, "type": "application/zip"}, "the package"), iterations=3)
    assert inputs_of(state, "smooth") == {"method": "hc", "iterations": 3, "package": {"href": PACKAGE}}
    client.heal({"skin": b"solid", "fat": PACKAGE.replace("package", "fat")})
    assert set(inputs_of(state, "heal")["meshes"]) == {"skin", "fat"}
    with pytest.raises(ArgumentError):
        client.smooth(tmp_path / "nowhere.zip")


def test_segment_sends_the_volume_and_names_of_labels(state: State, files: dict[str, str], tmp_path: Path) -> None:
    volume = tmp_path / "head.nii.gz"
    volume.write_bytes(b"labels")
    names = ("--name", "2=white_matter", "--name", "41=white_matter")
    inputs = sent(
        state, "segment", str(volume), *names, "--islands", "keep_above", "--min-island", "50", "--inside", "white_matter=csf"
    )
    assert set(inputs) == {"volume", "names", "islands", "min_island_mm3", "inside"}
    assert inputs["names"] == {"2": "white_matter", "41": "white_matter"}
    assert inputs["volume"]["href"].startswith("/v1/meshes/")
    assert (inputs["min_island_mm3"], inputs["inside"]) == (50.0, {"white_matter": "csf"})
    for wrong in ("white=2", "2=", "2"):
        assert main(["segment", str(volume), "--name", wrong]) == 2


def test_segment_of_the_python_client(state: State, files: dict[str, str], lab: tuple[str, State]) -> None:
    will_end(state)
    with Client(lab[0]) as client:
        assert client.segment(files["skin"], names={3: "csf"}, cavities="keep").verdict == "simulation_ready"
    inputs = inputs_of(state, "segment")
    assert (inputs["names"], inputs["cavities"]) == ({"3": "csf"}, "keep")
