"""What `integument fields` and `Client.fields` send."""

from __future__ import annotations

from pathlib import Path

import pytest
from integument import ArgumentError, Client
from integument.cli import main
from integument.cli.column_words import join_columns, split_columns
from integument.cli.placement_file import read_placement

from tests.client.faulty_server import JOB_ID, State
from tests.client.test_surface_commands import inputs_of, sent, will_end

PACKAGE = f"/v1/jobs/{JOB_ID}/results/package"
COLUMNS = ["x", "y", "z", "Ex", "Ey", "Ez"]


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lab: tuple[str, State]) -> dict[str, str]:
    monkeypatch.setenv("INTEGUMENT_URL", lab[0])
    paths = {name: tmp_path / name for name in ("skin.stl", "fat.stl", "field.csv", "coil.ccd", "placement.txt")}
    for path in paths.values():
        path.write_bytes(b"any")
    paths["placement.txt"].write_text("[1 0 0 10; 0 1 0 20\n0 0 1 30; 0 0 0 1]")
    return {name: str(path) for name, path in paths.items()}


def test_all_options_as_typed(state: State, files: dict[str, str]) -> None:
    inputs = sent(
        *(state, "fields", files["skin.stl"], files["field.csv"], "--columns", *COLUMNS, "--coil", files["coil.ccd"]),
        *("--placement", files["placement.txt"], "--field-unit", "mV/mm", "--method", "nearest", "--max-distance", "2"),
        *("--inward", "1", "--leave-out-nan"),
    )
    assert set(inputs) == {
        *("mesh", "field", "columns", "coil", "field_unit", "method", "max_distance_mm", "inward_mm", "not_finite"),
    }
    assert inputs["columns"] == COLUMNS
    assert inputs["coil"]["placement"] == [[1, 0, 0, 10], [0, 1, 0, 20], [0, 0, 1, 30], [0, 0, 0, 1]]
    assert (inputs["not_finite"], inputs["field_unit"], inputs["max_distance_mm"]) == ("leave_out", "mV/mm", 2.0)
    assert inputs["field"]["href"].startswith("/v1/meshes/")


def test_several_surfaces_or_a_package_and_last_the_field(state: State, files: dict[str, str]) -> None:
    inputs = sent(state, "fields", files["skin.stl"], files["fat.stl"], files["field.csv"])
    assert set(inputs) == {"meshes", "field"}
    assert set(inputs["meshes"]) == {"skin", "fat"}


def test_tissues_of_a_package(state: State, files: dict[str, str]) -> None:
    inputs = sent(state, "fields", PACKAGE, files["field.csv"], "--only", "fat", "--data", "E")
    assert (inputs["package"], inputs["only"], inputs["data"]) == ({"href": PACKAGE}, ["fat"], "E")


def test_what_is_missing_is_bad_input(state: State, files: dict[str, str]) -> None:
    assert main(["fields", files["field.csv"]]) == 2
    assert main(["fields", files["skin.stl"], "nowhere.csv"]) == 2
    assert main(["fields", files["skin.stl"], files["field.csv"], "--placement", files["placement.txt"]]) == 2
    assert state.requests("POST", "/v1/processes/fields/execution") == []


def test_the_python_client(state: State, files: dict[str, str], lab: tuple[str, State]) -> None:
    will_end(state)
    with Client(lab[0]) as client:
        placement = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
        job = client.fields(
            files["skin.stl"], files["field.csv"], columns=COLUMNS, coil=files["coil.ccd"], placement=placement, method="nearest"
        )
    assert job.verdict == "simulation_ready"
    inputs = inputs_of(state, "fields")
    assert (inputs["columns"], inputs["method"]) == (COLUMNS, "nearest")
    assert inputs["coil"]["placement"] == placement


def test_words_behind_columns_are_one_until_an_option_or_a_file() -> None:
    assert join_columns(["fields", "a.stl", "b.csv", "--columns", "-", "x", "y", "magE", "-o", "c.zip"]) == [
        *("fields", "a.stl", "b.csv", "--columns", "- x y magE", "-o", "c.zip"),
    ]
    assert join_columns(["fields", "--columns", "x", "y", "a.stl", "dir/b"]) == ["fields", "--columns", "x y", "a.stl", "dir/b"]
    assert join_columns(["--columns"]) == ["--columns"]
    assert join_columns(["--", "--columns", "x", "y"]) == ["--", "--columns", "x", "y"]
    assert split_columns("x, y;z  Ex") == ["x", "y", "z", "Ex"]


@pytest.mark.parametrize("text", ["1 2 3", "a b", ""])
def test_placements_that_are_none(tmp_path: Path, text: str) -> None:
    path = tmp_path / "placement.txt"
    path.write_text(text)
    with pytest.raises(ArgumentError):
        read_placement(path)
