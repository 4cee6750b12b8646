import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from integument.cli import main

from tests.client.faulty_server import JOB_ID, MESH_ID, Refuse, State

REPORT: dict[str, Any] = {
    "process": "shells",
    "verdict": "simulation_ready",
    "summary": "Three shells, no intersections.",
    "meshes": {
        "fat": {"vertices": 8, "faces": 26756, "self_intersecting_pairs": 0, "quality": {"minimum": 0.0312, "median": 0.9}},
        "skin": {"vertices": 8, "faces": 26756, "self_intersecting_pairs": 2, "quality": {"minimum": 0.5, "median": 0.9}},
    },
    "pairs": [{"a": "skin", "b": "fat", "relation": "b_inside_a", "intersecting_pairs": 1, "min_gap_mm": 0.0213}],
    "thickness": {"fat": {"target_mm": 1.0, "on_target_area": 0.974, "limited_area": 0.021, "missed_area": 0.005}},
    "findings": [
        {"code": "layer.limited", "severity": "info", "message": "2.1 % of fat is limited", "count": 3, "places": []},
        {"code": "mesh.self_intersecting", "severity": "error", "message": "2 pairs meet", "count": 2, "places": []},
    ],
}


@pytest.fixture
def skin(tmp_path: Path) -> str:
    path = tmp_path / "skin.stl"
    path.write_bytes(b"solid")
    return str(path)


@pytest.fixture(autouse=True)
def _server(monkeypatch: pytest.MonkeyPatch, lab: tuple[str, State]) -> None:
    monkeypatch.setenv("INTEGUMENT_URL", lab[0])


def end(state: State, status: str = "successful", verdict: str | None = "simulation_ready", **more: Any) -> None:
    """The job that is about to be made is over as soon as it exists."""
    state.events = [
        (1, "progress", {"progress": 40, "phase": "fat", "message": "[bold] 12,000 faces"}),
        (2, "log", {"message": "half way"}),
        (3, "done", {"status": status}),
    ]
    add = state.add_job
    state.add_job = lambda *_a, **k: add(status, verdict=verdict, **{**k, **more})  # type: ignore[method-assign]


def test_shells_ready(state: State, skin: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    end(state)
    state.report = REPORT
    state.files[f"/v1/jobs/{JOB_ID}/results/package"] = b"zip"
    target = tmp_path / "package.zip"
    region = "right_ear:-1,2,3:4,5,6:fat=0.3,average_body=0.6:5"
    arguments = ["shells", skin, "--unit", "cm", "--layer", "fat=1", "--layer", "average_body=3", "--region", region]
    assert main([*arguments, "--min-gap", "0.05", "-o", str(target)]) == 0
    out, err = capsys.readouterr()
    assert target.read_bytes() == b"zip"
    sent = json.loads(state.requests("POST", "/v1/processes/shells/execution")[0].body)["inputs"]
    assert sent["regions"][0] == {
        "name": "right_ear",
        "box_mm": {"min": [-1.0, 2.0, 3.0], "max": [4.0, 5.0, 6.0]},
        "depths_mm": {"fat": 0.3, "average_body": 0.6},
        "blend_mm": 5.0,
    }
    assert state.uploads[0]["unit"] == b"cm"
    assert "simulation_ready  Three shells, no intersections." in out
    rows = [line.split() for line in out.splitlines() if line.strip().startswith(("skin", "fat"))]
    assert rows == [
        ["skin", "26,756", "–", "–", "–", "0.021", "3", "0.500"],
        ["fat", "26,756", "1.00", "97.4%", "2.1%", "0.021", "1", "0.031"],
    ]
    assert out.index("mesh.self_intersecting: 2 pairs meet") < out.index("layer.limited")
    assert f"package: {target}" in out
    assert "40 % fat  [bold] 12,000 faces" in err
    assert "half way" in err


def test_shells_not_ready(state: State, skin: str, capsys: pytest.CaptureFixture[str]) -> None:
    end(state, verdict="not_ready")
    state.report = REPORT | {"verdict": "not_ready"}
    assert main(["shells", skin]) == 1
    assert "not_ready" in capsys.readouterr().out


def test_json_is_one_document_and_progress_is_lines(state: State, skin: str, capsys: pytest.CaptureFixture[str]) -> None:
    end(state)
    state.report = REPORT
    assert main(["shells", skin, "--json"]) == 0
    out, err = capsys.readouterr()
    document = json.loads(out)
    assert document["job"]["jobID"] == JOB_ID
    assert document["report"] == REPORT
    assert document["exit_code"] == 0
    assert [json.loads(line)["event"] for line in err.splitlines()] == ["progress", "log", "done"]


def test_quiet_says_only_the_result(state: State, skin: str, capsys: pytest.CaptureFixture[str]) -> None:
    end(state)
    state.report = REPORT
    assert main(["-q", "shells", skin]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert "simulation_ready" in out


def test_a_failed_job_shows_its_report_and_ends_with_1(state: State, skin: str, capsys: pytest.CaptureFixture[str]) -> None:
    failure = {"code": "skin.not_closed", "class": "input", "message": "3 edges are open", "retryable": False}
    end(state, "failed", verdict=None, failure=failure)
    state.report = REPORT | {"verdict": "not_ready"}
    assert main(["shells", skin]) == 1
    out, err = capsys.readouterr()
    assert "mesh.self_intersecting" in out
    assert "failed: skin.not_closed: 3 edges are open" in err


def test_a_failed_job_without_report(state: State, skin: str, capsys: pytest.CaptureFixture[str]) -> None:
    end(state, "failed", verdict=None, failure={"code": "worker.lost", "class": "internal", "message": "gone"})
    assert main(["shells", skin, "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["report"] is None


def test_what_a_failed_job_left_is_told_and_fetched_where_it_was_asked_for(
    state: State, skin: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = f"/v1/jobs/{JOB_ID}"
    links = [{"rel": "item", "href": f"http://lab{path}/results/{name}", "type": "model/stl"} for name in ("skin", "steps")]
    failure = {"code": "tissues.cross", "class": "input", "message": "they cross", "retryable": False}
    end(state, "failed", verdict=None, failure=failure, links=[{"rel": "self", "href": f"http://lab{path}"}, *links])
    state.files[f"{path}/results/steps"] = b"{}"
    wanted = ["-o", str(tmp_path / "package.zip"), "--steps", str(tmp_path / "steps.json")]
    assert main(["prepare", skin, *wanted, "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["files"] == {"steps": str(tmp_path / "steps.json")}
    assert not (tmp_path / "package.zip").exists()
    assert main(["report", JOB_ID]) == 1
    assert f"left: skin, steps; fetch one with `integument download {JOB_ID} skin`" in " ".join(capsys.readouterr().err.split())
    assert main(["job", JOB_ID]) == 0
    assert "skin, steps" in capsys.readouterr().out


def test_a_refusal_is_bad_input_and_names_the_places(state: State, skin: str, capsys: pytest.CaptureFixture[str]) -> None:
    state.faults["POST /v1/processes/shells/execution"].append(Refuse(422, "inputs.invalid"))
    assert main(["shells", skin]) == 2
    assert "error: inputs.invalid: not now" in capsys.readouterr().err
    state.faults["POST /v1/processes/shells/execution"].append(Refuse(422, "inputs.invalid"))
    assert main(["shells", skin, "--json"]) == 2
    document = json.loads(capsys.readouterr().out)
    assert document["error"]["problem"]["code"] == "inputs.invalid"
    assert document["exit_code"] == 2


def test_nobody_there_is_3(skin: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("integument.backoff.LONGEST_PAUSE_S", 0.01)
    assert main(["jobs", "--server", "http://127.0.0.1:1"]) == 3
    assert "no answer from http://127.0.0.1:1" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments",
    [
        ["shells"],
        ["shells", "/nowhere.stl"],
        ["shells", "SKIN", "--layer", "fat"],
        ["shells", "SKIN", "--layer", "fat=1", "--layer", "fat=2"],
        ["shells", "SKIN", "--layer", "fat=nan"],
        ["shells", "SKIN", "--region", "ear:0,0:1,1,1:fat=1"],
        ["shells", "SKIN", "--region", "ear"],
        ["shells", "SKIN", "--unit", "parsec"],
        ["shells", "SKIN", "--thin-policy", "hope"],
        ["shells", "SKIN", "-o", "/nowhere/package.zip"],
        ["validate"],
        ["run", "shells", "--inputs", "/nowhere.json"],
        ["run", "shells", "--inputs", "SKIN"],
        ["run", "shells", "--inputs", "SKIN", "-o", "package"],
        ["nonsense"],
        ["jobs", "--server", "nonsense"],
        ["jobs", "--status", "sleeping"],
        ["graft", "SKIN", "SKIN"],
        ["graft", "SKIN", "/nowhere.stl", "--region", "ear:0,0,0:1,1,1"],
        ["graft", "SKIN", "SKIN", "--region", "ear:0,0,0:1,1"],
        ["detach", "SKIN"],
        ["detach", "SKIN", "--region", "arm:0,0,0:1,1,1:many"],
        ["graft", "SKIN", "SKIN", "--region", "ear:0,0,0:1,1,1:fat=1"],
    ],
)
def test_bad_usage_is_2_and_nothing_is_queued(arguments: list[str], state: State, skin: str) -> None:
    assert main([skin if word == "SKIN" else word for word in arguments]) == 2
    assert state.jobs == {}


def test_validate_names_meshes_after_their_files(state: State, tmp_path: Path) -> None:
    end(state)
    state.report = REPORT
    paths = []
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        paths.append(tmp_path / folder / "left ear (1).stl")
        paths[-1].write_bytes(b"x")
    held = f"/v1/jobs/{JOB_ID}/results/fat"
    assert main(["validate", *map(str, paths), held]) == 0
    sent = json.loads(state.requests("POST", "/v1/processes/validate/execution")[0].body)["inputs"]["meshes"]
    assert list(sent) == ["left_ear_1_", "left_ear_1__2", "fat"]
    assert sent["fat"] == {"href": held}
    assert sent["left_ear_1_"] == {"href": f"/v1/meshes/{MESH_ID}"}


def test_graft_sends_two_meshes_and_boxes(state: State, skin: str, tmp_path: Path) -> None:
    end(state)
    state.report = REPORT
    state.files[f"/v1/jobs/{JOB_ID}/results/mesh"] = b"stl"
    target = tmp_path / "joined.stl"
    donor = f"/v1/jobs/{JOB_ID}/results/fat"
    arguments = ["graft", skin, donor, "--region", "ear:-1,2,3:4,5,6", "--region", "other:1,2,3:4,5,6.5", "-o", str(target)]
    assert main([*arguments, "--seam", "2.5", "--max-distance", "4"]) == 0
    sent = json.loads(state.requests("POST", "/v1/processes/graft/execution")[0].body)["inputs"]
    assert sent == {
        "base": {"href": f"/v1/meshes/{MESH_ID}"},
        "donor": {"href": donor},
        "regions": [
            {"name": "ear", "box_mm": {"min": [-1.0, 2.0, 3.0], "max": [4.0, 5.0, 6.0]}},
            {"name": "other", "box_mm": {"min": [1.0, 2.0, 3.0], "max": [4.0, 5.0, 6.5]}},
        ],
        "seam_mm": 2.5,
        "max_distance_mm": 4.0,
    }
    assert target.read_bytes() == b"stl"


def test_detach_sends_boxes_with_the_number_of_contacts(state: State, skin: str, tmp_path: Path) -> None:
    end(state)
    state.report = REPORT
    state.files[f"/v1/jobs/{JOB_ID}/results/skin"] = b"stl"
    target = tmp_path / "apart.stl"
    arguments = ["detach", skin, "--region", "arm:-1,2,3:4,5,6", "--region", "fingers:1,2,3:4,5,6.5:3", "-o", str(target)]
    assert main([*arguments, "--gap", "0.5", "--pieces", "2", "--narrowing", "0.7", "--max-contact", "30"]) == 0
    sent = json.loads(state.requests("POST", "/v1/processes/detach/execution")[0].body)["inputs"]
    assert sent == {
        "skin": {"href": f"/v1/meshes/{MESH_ID}"},
        "regions": [
            {"name": "arm", "box_mm": {"min": [-1.0, 2.0, 3.0], "max": [4.0, 5.0, 6.0]}},
            {"name": "fingers", "box_mm": {"min": [1.0, 2.0, 3.0], "max": [4.0, 5.0, 6.5]}, "contacts": 3},
        ],
        "gap_mm": 0.5,
        "pieces": 2,
        "narrowing": 0.7,
        "max_contact_cm2": 30.0,
    }
    assert target.read_bytes() == b"stl"


def test_graft_leaves_defaults_to_the_server(state: State, skin: str) -> None:
    end(state)
    state.report = REPORT
    assert main(["graft", skin, skin, "--region", "ear:-1,2,3:4,5,6"]) == 0
    sent = json.loads(state.requests("POST", "/v1/processes/graft/execution")[0].body)["inputs"]
    assert set(sent) == {"base", "donor", "regions"}
    assert len(state.uploads) == 1  # the same file is sent once


@pytest.mark.parametrize("document", [{"skin": 1}, {"inputs": {"skin": 1}, "response": "document"}])
def test_run_takes_inputs_or_a_whole_request(document: dict[str, Any], state: State, tmp_path: Path) -> None:
    end(state)
    state.report = REPORT
    state.files[f"/v1/jobs/{JOB_ID}/results/package"] = b"zip"
    path = tmp_path / "inputs.json"
    path.write_text(json.dumps(document))
    assert main(["run", "shells", "--inputs", str(path), "-o", f"package={tmp_path / 'p.zip'}"]) == 0
    assert json.loads(state.requests("POST", "/v1/processes/shells/execution")[0].body) == {"inputs": {"skin": 1}}
    assert (tmp_path / "p.zip").exists()


def test_commands_about_jobs(state: State, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    failure = {"code": "worker.lost", "class": "internal", "message": "the worker is gone"}
    state.add_job("failed", failure=failure, created="2026-01-02T03:04:05Z")
    state.events = [(1, "progress", {"progress": 5, "phase": "skin", "message": "reading"}), (2, "done", {"status": "failed"})]

    assert main(["jobs", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)[0]["failure"] == failure
    assert main(["jobs"]) == 0
    assert "worker.lost" in capsys.readouterr().out
    assert main(["job", JOB_ID]) == 0
    assert "worker.lost (internal): the worker is gone" in capsys.readouterr().out
    for follow in ([], ["--follow"]):
        assert main(["logs", JOB_ID, *follow]) == 0
        assert "progress 5 %  skin  reading" in capsys.readouterr().out
    assert main(["logs", JOB_ID, "--json"]) == 0
    assert [event["id"] for event in json.loads(capsys.readouterr().out)] == ["1", "2"]
    assert main(["cancel", JOB_ID]) == 2
    assert main(["job", "33333333-3333-4333-8333-333333333333"]) == 2


def test_retry_watches_the_job_to_its_new_end(state: State, capsys: pytest.CaptureFixture[str]) -> None:
    state.add_job("failed")
    state.after_retry = "successful"
    state.report = REPORT
    state.events = [(1, "done", {"status": "failed", "attempt": 1}), (2, "done", {"status": "successful", "attempt": 2})]
    state.jobs[JOB_ID]["verdict"] = "simulation_ready"
    assert main(["retry", JOB_ID, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["job"]["attempt"] == 2


def test_cancel_report_and_download(state: State, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = state.add_job("running")
    assert main(["report", JOB_ID]) == 2
    assert main(["cancel", JOB_ID]) == 0
    assert job["status"] == "dismissed"
    job |= {"status": "successful", "verdict": "not_ready"}
    state.report = REPORT | {"verdict": "not_ready"}
    capsys.readouterr()
    assert main(["report", JOB_ID, "-o", str(tmp_path / "report.html"), "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["files"] == {"report_html": str(tmp_path / "report.html")}
    state.files[f"/v1/jobs/{JOB_ID}/results/package"] = b"zip"
    assert main(["download", JOB_ID, "package", str(tmp_path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {
        "output": "package",
        "file": str(tmp_path / "package.zip"),
        "size_bytes": 3,
    }


def test_catalogue(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["processes"]) == 0
    assert "shells" in capsys.readouterr().out
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("integument 0.")


def test_ctrl_c_leaves_the_job_of_a_shared_server_alone_and_says_how_to_follow_it(lab: tuple[str, State], skin: str) -> None:
    url, state = lab
    state.events = [(1, "progress", {"progress": 1, "phase": "fat", "message": "working"})]
    state.endless_events = True
    command = [sys.executable, "-m", "integument", "--server", url, "shells", skin]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env={**os.environ, "COLUMNS": "200"}) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if "working" in line:
                break
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
    assert process.returncode == 130
    assert f"integument logs {JOB_ID} --follow" in rest
    assert state.jobs[JOB_ID]["status"] == "running"
