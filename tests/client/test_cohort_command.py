"""`integument cohort`, `cohorts`, `label` and the search of `jobs` against the real server: nothing here is played."""

from __future__ import annotations

import csv
import io
import json
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import trimesh
from integument import Client, EmbeddedServer
from integument.cli import main


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with EmbeddedServer(tmp_path_factory.mktemp("data")) as running:
        yield running.url


@pytest.fixture
def client(server: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[Client]:
    monkeypatch.setenv("INTEGUMENT_URL", server)
    with Client() as client:
        yield client


@pytest.fixture
def skins(tmp_path: Path) -> list[str]:
    """Two balls, one of them open."""
    paths = []
    for name in ("anna", "open"):
        ball = trimesh.creation.icosphere(1, 60.0)
        if name == "open":
            ball.update_faces([index > 0 for index in range(len(ball.faces))])
        path = tmp_path / f"{name}.stl"
        ball.export(path)
        paths.append(str(path))
    return paths


def told(capsys: pytest.CaptureFixture[str]) -> Any:
    return json.loads(capsys.readouterr().out)


def test_subjects_from_files_to_table(
    client: Client, skins: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    inputs, own = tmp_path / "inputs.json", tmp_path / "own.json"
    inputs.write_text('{"min_gap_mm": 0.5}')
    own.write_text('{"open": {"min_gap_mm": 0.25}}')
    files = {name: tmp_path / name for name in ("all.zip", "table.csv", "page.html")}
    command = ["cohort", *skins, "--process", "validate", "--inputs", str(inputs), "--overrides", str(own), "--name", "Pilot"]
    command += [
        "--label",
        "ages",
        "-o",
        str(files["all.zip"]),
        "--table",
        str(files["table.csv"]),
        "--report",
        str(files["page.html"]),
    ]
    assert main([*command, "--json"]) == 1, "one of them is not ready"
    document = told(capsys)
    assert (document["cohort"]["ready"], document["cohort"]["subjects"]) == (1, 2)
    assert [(job["subject"], job["verdict"]) for job in document["jobs"]] == [("anna", "simulation_ready"), ("open", "not_ready")]
    with zipfile.ZipFile(files["all.zip"]) as archive:
        gaps = {name: json.loads(archive.read(name))["parameters"]["min_gap_mm"] for name in archive.namelist()}
    assert gaps == {"anna/report.json": 0.5, "open/report.json": 0.25}
    assert [row["subject"] for row in csv.DictReader(io.StringIO(files["table.csv"].read_text()))] == ["anna", "open"]
    assert "Pilot" in files["page.html"].read_text(encoding="utf-8")

    cohort = document["cohort"]["id"]
    assert main(["cohorts", cohort]) == 0
    shown = capsys.readouterr().out
    assert "anna" in shown
    assert "not_ready" in shown
    assert main(["cohorts", cohort, "--retry"]) == 2, "nobody failed"
    assert main(["jobs", "--label", "ages", "--search", "pilot", "--json"]) == 0
    assert {job["subject"] for job in told(capsys) if "subject" in job} == {"anna", "open"}
    assert main(["cohorts", cohort, "--dismiss"]) == 0
    capsys.readouterr()
    assert main(["cohorts", "--json"]) == 0
    assert told(capsys) == []


def test_an_archive_with_a_broken_file(
    client: Client, skins: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = tmp_path / "study.zip"
    with zipfile.ZipFile(study, "w") as archive:
        archive.write(skins[0], "anna.stl")
        archive.writestr("torn.stl", "no mesh")
    assert main(["cohort", str(study), "--process", "validate"]) == 1
    shown = capsys.readouterr().out
    assert "stl.not_stl" in shown
    assert "simulation_ready" in shown


def test_a_job_is_named_later(client: Client, skins: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    job = client.validate(skins[0])
    assert main(["label", job.id, "--name", "Anna, second try", "--label", "pilot", "--label", "ages"]) == 0
    assert "Anna, second try" in capsys.readouterr().out
    assert [found.id for found in client.jobs(labels=["pilot", "ages"], text="second")] == [job.id]
    assert main(["label", job.id, "--name", "", "--label", ""]) == 0
    assert (client.job(job.id).name, client.job(job.id).labels) == (None, ())
    assert main(["label", job.id]) == 2
    assert next(client.meshes(text="anna")).name == "anna"


@pytest.mark.parametrize(
    "command",
    [
        ["cohort", "a.stl", "b/a.stl", "--process", "validate"],
        ["cohort", "a.stl", "--process", "validate", "--overrides", "none.json"],
        ["cohort", "a.stl", "--process", "validate", "-o", "nowhere/all.zip"],
        ["cohorts", "--retry"],
        ["cohorts", "x", "--retry", "--dismiss"],
    ],
)
def test_what_is_typed_wrong_is_told_before_a_server_is_asked(
    command: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("INTEGUMENT_URL", "http://127.0.0.1:1")
    (tmp_path / "b").mkdir()
    for name in ("a.stl", "b/a.stl"):
        (tmp_path / name).write_bytes(b"solid")
    assert main(command) == 2
