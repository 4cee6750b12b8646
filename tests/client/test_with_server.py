"""Client and command line against the real server: nothing here is played."""

from __future__ import annotations

import hashlib
import json
import os
import signal
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest
import trimesh
from integument import Client, EmbeddedServer, JobDismissedError, ProblemError
from integument.cli import main

from core.io.registry import write_mesh
from subjects.body import body


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
def skin(tmp_path: Path) -> Path:
    path = tmp_path / "skin.stl"
    trimesh.creation.icosphere(3, 60.0).export(path)
    return path


@pytest.fixture
def open_skin(tmp_path: Path) -> Path:
    sphere = trimesh.creation.icosphere(3, 60.0)
    sphere.update_faces([index > 0 for index in range(len(sphere.faces))])
    path = tmp_path / "open.stl"
    sphere.export(path)
    return path


def test_shells_from_file_to_package(client: Client, skin: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    package, page = tmp_path / "package.zip", tmp_path / "report.html"
    assert main(["shells", str(skin), "--layer", "fat=2", "-o", str(package), "--report", str(page), "--json"]) == 0
    out, err = capsys.readouterr()
    document = json.loads(out)
    assert document["report"]["thickness"]["fat"]["on_target_area"] > 0.99
    assert {"stl/skin.stl", "stl/fat.stl", "manifest.json"} <= set(zipfile.ZipFile(package).namelist())
    assert page.read_text(encoding="utf-8").lstrip().lower().startswith("<!doctype html")
    percents = [event["progress"] for line in err.splitlines() if "progress" in (event := json.loads(line))]
    assert percents == sorted(percents)
    assert percents[-1] == 100

    job_id = document["job"]["jobID"]
    events = list(client.events(job_id))
    assert [int(event.id) for event in events] == list(range(1, len(events) + 1))
    assert events[-1].type == "done"
    assert len(list(client.events(job_id, follow=False))) == len(events)

    # what one job made is the input of the next; half a download goes on
    assert client.validate({"skin": f"/v1/jobs/{job_id}/results/skin", "fat": client.results(job_id).outputs["fat"]}).ready
    content = package.read_bytes()
    (tmp_path / "again.zip.part").write_bytes(content[:1000])
    (tmp_path / "again.zip.part.etag").write_text(f'"{hashlib.sha256(content).hexdigest()}"', encoding="ascii")
    told: list[tuple[int, int]] = []
    again = client.download(job_id, "package", tmp_path / "again.zip", on_bytes=lambda done, total: told.append((done, total)))
    assert again.read_bytes() == content
    assert told[0][0] > 1000
    assert client.download(job_id, "package", tmp_path).parent == tmp_path


def test_an_open_mesh_is_not_ready_and_no_skin(client: Client, open_skin: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", str(open_skin)]) == 1
    assert "mesh.not_closed" in capsys.readouterr().out
    assert main(["shells", str(open_skin), "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert document["job"]["failure"]["code"] == "skin.not_closed"
    assert document["report"]["verdict"] == "not_ready"
    again = client.retry(document["job"]["jobID"])
    assert again.attempt == document["job"]["attempt"] + 1
    assert main(["logs", again.id, "--follow"]) == 0
    assert client.job(again.id).status == "failed"


def test_refusals_name_what_is_wrong(client: Client, skin: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = tmp_path / "text.stl"
    text.write_text("no mesh at all")
    assert main(["shells", str(text)]) == 2
    assert "error: " in capsys.readouterr().err
    assert main(["shells", str(skin), "--layer", "fat=3", "--layer", "average_body=1"]) == 2
    assert "increase" in capsys.readouterr().err
    with pytest.raises(ProblemError) as caught:
        client.execute("levitate", {})
    assert (caught.value.status, caught.value.code) == (404, "process.not_found")
    with pytest.raises(ProblemError) as caught:
        client.job("33333333-3333-4333-8333-333333333333")
    assert caught.value.code == "job.not_found"


def test_one_key_is_one_job(client: Client, skin: Path) -> None:
    inputs = {"meshes": {"href": client.upload_mesh(skin).href}}
    first = client.execute("validate", inputs, idempotency_key="monday")
    assert client.execute("validate", inputs, idempotency_key="monday").id == first.id
    with pytest.raises(ProblemError) as caught:
        client.execute("validate", {**inputs, "min_gap_mm": 1.0}, idempotency_key="monday")
    assert caught.value.code == "idempotency.mismatch"
    client.wait(first)
    assert first.id in {job.id for job in client.jobs(status="successful", process="validate")}
    client.remove(first)
    with pytest.raises(ProblemError):
        client.job(first.id)


def test_meshes_and_processes_are_described(client: Client, skin: Path) -> None:
    sent = [client.upload_mesh(skin, name=f"mesh_{number}").id for number in range(3)]
    assert [mesh.id for mesh in client.meshes(limit=3)] == sent[::-1]
    assert client.mesh(sent[0]).faces == 1280
    assert set(client.process("shells").inputs) >= {"skin", "layers", "regions", "thin_policy", "min_gap_mm", "skin_shift_mm"}


def test_dismiss_ends_the_watch(client: Client, tmp_path: Path) -> None:
    write_mesh(body(0), tmp_path / "body.stl", "stl", "body")
    job = client.execute("shells", {"skin": {"href": client.upload_mesh(tmp_path / "body.stl").href}})
    for event in client.events(job):
        if event.type == "progress":
            client.dismiss(job)
            break
    with pytest.raises(JobDismissedError):
        client.wait(job)


def test_ctrl_c_dismisses_the_job_when_the_server_was_started_for_the_call(tmp_path: Path) -> None:
    write_mesh(body(0), tmp_path / "body.stl", "stl", "body")
    environment = {name: value for name, value in os.environ.items() if name != "INTEGUMENT_URL"}
    environment["INTEGUMENT_DATA_DIR"] = str(tmp_path / "data")
    command = [sys.executable, "-m", "integument", "shells", str(tmp_path / "body.stl")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if " % " in line:
                break
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
    assert process.returncode == 130
    assert "was dismissed" in rest
    assert not (tmp_path / "data" / "server.json").exists()


def test_jobs_are_named_and_a_wrong_unit_is_told_at_once(
    client: Client, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tall = tmp_path / "tall.stl"
    trimesh.creation.box((1700.0, 400.0, 300.0)).export(tall)  # mm, and said to be m
    main(["validate", str(tall), "--unit", "m", "--name", "Anna", "--label", "pilot", "--label", "ages"])
    assert "warning mesh.unit_suspicious: tall is 1.7e+06 mm long" in capsys.readouterr().err
    [job] = client.jobs(labels=["pilot", "ages"], text="anna")
    assert (job.name, job.process) == ("Anna", "validate")
    main(["validate", str(tall), "--unit", "m", "--json"])
    told = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert [one["code"] for one in told if one["event"] == "finding"] == ["mesh.unit_suspicious"]
