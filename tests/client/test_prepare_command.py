"""What `integument prepare` sends."""

import json
from pathlib import Path
from typing import Any

import pytest
from integument import Client
from integument.cli import main

from tests.client.faulty_server import State


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lab: tuple[str, State]) -> dict[str, str]:
    monkeypatch.setenv("INTEGUMENT_URL", lab[0])
    paths = {name: tmp_path / f"{name}.stl" for name in ("skin", "left", "skull", "brain")}
    for path in paths.values():
        path.write_bytes(b"solid")
    return {name: str(path) for name, path in paths.items()}


def will_end(state: State) -> None:
    state.events = [(1, "done", {"status": "successful"})]
    add = state.add_job
    state.add_job = lambda *_a, **k: add("successful", verdict="simulation_ready", **k)  # type: ignore[method-assign]


def inputs_of(state: State) -> dict[str, Any]:
    inputs: dict[str, Any] = json.loads(state.requests("POST", "/v1/processes/prepare/execution")[0].body)["inputs"]
    return inputs


def sent(state: State, *arguments: str) -> dict[str, Any]:
    """The inputs of the job that the command makes."""
    will_end(state)
    assert main(["prepare", *arguments]) == 0
    return inputs_of(state)


def test_the_servers_defaults_hold_for_what_was_not_typed(state: State, files: dict[str, str]) -> None:
    assert set(sent(state, files["skin"])) == {"skin", "thin_policy"}


def test_ears_tissues_and_steps_are_sent_as_typed(state: State, files: dict[str, str]) -> None:
    inputs = sent(
        state,
        *(files["skin"], "--ears", "auto", "--canal", files["left"], "--decimate", "0.5", "--no-heal"),
        *("--tissue", f"skull={files['skull']}", "--tissue", f"brain={files['brain']}"),
        *("--inside", "brain=skull", "--conductivity", "brain=0.33", "--conductivity", "skin=0.4"),
        *("--detach", "arm:1,2,3:4,5,6", "--smooth", "--tissue-gap", "0.2"),
        *("--mesher", "tetgen", "--radius-edge", "0", "--max-volume", "fat=5", "--skin-shift", "1"),
    )
    assert (inputs["ears"], inputs["heal"], inputs["decimate"]) == ("auto", None, {"target_ratio": 0.5})
    assert [tissue["name"] for tissue in inputs["tissues"]] == ["skull", "brain"]
    assert inputs["tissues"][1] | {"mesh": None} == {
        "name": "brain",
        "mesh": None,
        "inside": "skull",
    }
    assert inputs["conductivities_s_per_m"] == {"brain": 0.33, "skin": 0.4}
    assert inputs["tetrahedra"] == {"mesher": "tetgen", "radius_edge": None, "max_volume_mm3": {"fat": 5.0}}
    assert inputs["detach"] == {"regions": [{"name": "arm", "box_mm": {"min": [1.0, 2.0, 3.0], "max": [4.0, 5.0, 6.0]}}]}
    assert inputs["smooth"] == {}
    assert inputs["separate"] == {"gap_mm": 0.2}
    assert len(inputs["canals"]) == 1
    assert len(state.uploads) == 4


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--tissue", "brain"], "wanted is NAME=MESH"),
        (["--tissue", "brain=nowhere.stl"], "nowhere.stl"),
        (["--inside", "brain=skull"], "there is no --tissue brain"),
        (["--conductivity", "brain=much"], "is no number"),
        (["--no-separate", "--tissue-gap", "1"], "does not go with --no-separate"),
        (["--decimate", "0.5", "--faces", "100"], "give one"),
        (["--no-tetrahedra", "--mesher", "gmsh"], "do not go with --no-tetrahedra"),
        (["--no-tetrahedra", "--radius-edge", "2"], "do not go with --no-tetrahedra"),
        (["--ears", "auto", "--ears", "a:1,2,3:4,5,6"], "does not go with boxes"),
    ],
)
def test_wrong_arguments_send_nothing(
    state: State, files: dict[str, str], capsys: pytest.CaptureFixture[str], arguments: list[str], words: str
) -> None:
    assert main(["prepare", files["skin"], *arguments]) == 2
    assert words in " ".join(capsys.readouterr().err.split())
    assert not state.uploads


def test_the_python_client_uploads_and_names_tissues(state: State, files: dict[str, str], lab: tuple[str, State]) -> None:
    will_end(state)
    with Client(lab[0]) as client:
        client.prepare(files["skin"], {"fat": 1.0}, tissues={"brain": files["brain"]}, ears="auto", heal=None, generate_canals={})
    inputs = inputs_of(state)
    assert inputs["layers"] == [{"name": "fat", "depth_mm": 1.0}]
    assert inputs["tissues"][0]["name"] == "brain"
    assert (inputs["ears"], inputs["heal"], inputs["generate_canals"]) == ("auto", None, {})
