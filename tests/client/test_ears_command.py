"""What `integument ears` sends."""

import json
from pathlib import Path
from typing import Any

import pytest
from integument.cli import main

from tests.client.faulty_server import State


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lab: tuple[str, State]) -> dict[str, str]:
    monkeypatch.setenv("INTEGUMENT_URL", lab[0])
    paths = {name: tmp_path / f"{name}.stl" for name in ("skin", "left", "right")}
    for path in paths.values():
        path.write_bytes(b"solid")
    return {name: str(path) for name, path in paths.items()}


def sent(state: State, *arguments: str) -> dict[str, Any]:
    """The inputs of the job that the command makes."""
    state.events = [(1, "done", {"status": "successful"})]
    add = state.add_job
    state.add_job = lambda *_a, **k: add("successful", verdict="simulation_ready", **k)  # type: ignore[method-assign]
    assert main(["ears", *arguments]) == 0
    body = json.loads(state.requests("POST", "/v1/processes/ears/execution")[0].body)
    inputs: dict[str, Any] = body["inputs"]
    return inputs


def test_both_ears_are_found_unless_boxes_are_given(state: State, files: dict[str, str]) -> None:
    inputs = sent(state, files["skin"], "--generate-canals")
    assert inputs["ears"] == "auto"
    assert inputs["generate_canals"] == {}
    assert "canals" not in inputs
    assert "ear_depths_mm" not in inputs


def test_boxes_canals_and_depths_are_sent_as_typed(state: State, files: dict[str, str]) -> None:
    inputs = sent(
        state,
        *(files["skin"], "--ears", "left_ear:1,2,3:4,5,6", "--canal", files["left"], "--canal", files["right"]),
        *("--layer", "fat=2", "--ear-depth", "fat=0.4", "--blend", "3", "--min-gap", "0.1"),
    )
    assert inputs["ears"] == [{"name": "left_ear", "box_mm": {"min": [1.0, 2.0, 3.0], "max": [4.0, 5.0, 6.0]}}]
    assert len(inputs["canals"]) == len(state.uploads) - 1 == 2
    assert inputs["layers"] == [{"name": "fat", "depth_mm": 2.0}]
    assert inputs["ear_depths_mm"] == {"fat": 0.4}
    assert (inputs["blend_mm"], inputs["min_gap_mm"]) == (3.0, 0.1)


def test_outer_layers_arrays_and_the_skins_shift_are_sent(state: State, files: dict[str, str]) -> None:
    layers = (
        "--layer",
        "fat=fat_depth_mm",
        "--outer-layer",
        "gel=2",
        "--layer",
        "average_body=6",
        "--outer-layer",
        "hair=hair_mm",
    )
    inputs = sent(state, files["skin"], *layers, "--skin-shift", "1.5")
    assert inputs["layers"] == [
        {"name": "gel", "depth_mm": 2.0, "side": "outside"},
        {"name": "hair", "depth_array": "hair_mm", "side": "outside"},
        {"name": "fat", "depth_array": "fat_depth_mm"},
        {"name": "average_body", "depth_mm": 6.0},
    ]
    assert inputs["skin_shift_mm"] == 1.5


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--ears", "auto", "--ears", "a:1,2,3:4,5,6"], "does not go with boxes"),
        (["--ears", "left:1,2:3,4"], "--ears left:1,2:3,4"),
        (["--canal", "nowhere.stl"], "nowhere.stl"),
        (["--ear-depth", "fat"], "--ear-depth fat"),
        (["--ear-depth", "fat=fat_mm"], "'fat_mm' is no number"),
        (["--layer", "fat=inf"], "'inf' is no finite number"),
        (["--outer-layer", "=2"], "--outer-layer =2"),
        (["--outer-layer", "gel=2", "--outer-layer", "gel=1"], "'gel' is there already"),
    ],
)
def test_what_is_mistyped_is_refused_before_anything_is_sent(
    state: State, files: dict[str, str], capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert main(["ears", files["skin"], *arguments]) == 2
    assert words in capsys.readouterr().err
    assert not state.uploads
