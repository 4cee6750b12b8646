import io
import json
from pathlib import Path
from typing import Any

import pytest
from integument import ArgumentError, Client, ProblemError, Region, ReplyError, ServerUnreachableError

from tests.client.faulty_server import JOB_ID, MESH_ID, Drop, Refuse, State, read_form

EXECUTION = "/v1/processes/shells/execution"
CONTENT = bytes(range(256)) * 1000


@pytest.mark.parametrize("kind", ["path", "text", "bytes", "file"])
def test_an_upload_arrives_whole_whatever_it_comes_from(client: Client, state: State, tmp_path: Path, kind: str) -> None:
    path = tmp_path / "haut ü.stl"
    path.write_bytes(CONTENT)
    file = io.BytesIO(b"junk" + CONTENT)
    file.seek(4)
    source: Any = {"path": path, "text": str(path), "bytes": CONTENT, "file": file}[kind]
    told: list[tuple[int, int]] = []
    mesh = client.upload_mesh(source, unit="m", name="skin", on_bytes=lambda done, total: told.append((done, total)))
    assert mesh.href == f"/v1/meshes/{MESH_ID}"
    assert state.uploads == [{"unit": b"m", "name": b"skin", "file": CONTENT}]
    assert told[0][0] < told[-1][0] == told[-1][1] == len(CONTENT)  # in pieces, not at once


def test_an_upload_whose_answer_is_lost_starts_again_and_is_one_upload(client: Client, state: State) -> None:
    state.faults["POST /v1/meshes"].append(Drop(after_work=True))
    client.upload_mesh(CONTENT)
    assert len(state.uploads) == 1
    first, second = state.requests("POST", "/v1/meshes")
    assert first.headers["idempotency-key"] == second.headers["idempotency-key"]
    for seen in (first, second):
        assert read_form(seen.headers["content-type"], seen.body)["file"] == CONTENT


def test_a_file_that_is_not_there_is_the_callers_fault(client: Client, state: State) -> None:
    with pytest.raises(ArgumentError, match=r"cannot read /nowhere/skin\.stl: No such file"):
        client.upload_mesh("/nowhere/skin.stl")
    assert state.seen == []


def test_a_lost_answer_to_execute_never_makes_two_jobs(client: Client, state: State) -> None:
    state.faults[f"POST {EXECUTION}"].extend([Drop(after_work=True), Refuse(409, "idempotency.in_flight"), Refuse(503)])
    assert client.execute("shells", {"skin": {"href": "/v1/meshes/x"}}).id == JOB_ID
    keys = {seen.headers["idempotency-key"] for seen in state.requests("POST", EXECUTION)}
    assert len(state.requests("POST", EXECUTION)) == 4
    assert len(keys) == 1
    client.execute("shells", {})
    assert state.seen[-1].headers["idempotency-key"] not in keys


def test_the_callers_own_key_is_sent(client: Client, state: State) -> None:
    client.execute("shells", {}, idempotency_key="monday")
    assert state.seen[-1].headers["idempotency-key"] == "monday"


@pytest.mark.parametrize("inputs", [{"min_gap_mm": float("nan")}, {"skin": object()}])
def test_inputs_that_are_no_json_are_not_sent(client: Client, state: State, inputs: dict[str, Any]) -> None:
    with pytest.raises(ArgumentError, match="no JSON"):
        client.execute("shells", inputs)
    assert state.seen == []


@pytest.mark.parametrize("status", [429, 502, 503, 504])
def test_transient_refusals_are_tried_again_and_then_told(client: Client, state: State, status: int) -> None:
    state.add_job()
    path = f"/v1/jobs/{JOB_ID}"
    state.faults[f"GET {path}"].extend([Refuse(status)] * 3)
    assert client.job(JOB_ID).id == JOB_ID
    state.faults[f"GET {path}"].extend([Refuse(status)] * 4)
    with pytest.raises(ProblemError) as caught:
        client.job(JOB_ID)
    assert (caught.value.status, caught.value.code) == (status, "server.busy")


@pytest.mark.parametrize("status", [400, 404, 409, 413, 422, 500])
def test_final_refusals_are_told_at_once(client: Client, state: State, status: int) -> None:
    state.faults[f"POST {EXECUTION}"].append(Refuse(status, "inputs.invalid"))
    with pytest.raises(ProblemError, match=r"inputs\.invalid: not now"):
        client.execute("shells", {})
    assert len(state.seen) == 1


def test_a_page_of_a_proxy_is_a_problem_too(client: Client, state: State) -> None:
    state.faults[f"POST {EXECUTION}"].append(Refuse(403, text="<h1>Go\naway</h1>"))
    with pytest.raises(ProblemError, match=r"http\.403: 403 Forbidden <h1>Go away</h1>"):
        client.execute("shells", {})


def test_something_else_at_the_address_is_named(client: Client, state: State) -> None:
    state.files["/v1/processes"] = b"<html>"
    with pytest.raises(ReplyError, match="application/zip, not JSON"):
        client.processes()
    state.jobs[JOB_ID] = {"jobID": JOB_ID, "status": "sleeping"}
    with pytest.raises(ReplyError, match="cannot read the job: status: Input should be 'accepted'"):
        client.job(JOB_ID)


def test_nobody_there(client: Client) -> None:
    with Client("http://127.0.0.1:1", retries=1, first_pause_s=0.001) as lost, pytest.raises(ServerUnreachableError) as caught:
        lost.processes()
    assert caught.value.url == "http://127.0.0.1:1"


@pytest.mark.parametrize("url", ["127.0.0.1:8000", "ftp://host", "http://", ""])
def test_addresses_that_are_none(url: str) -> None:
    with pytest.raises(ArgumentError, match="no server address"):
        Client(url or " ")


@pytest.mark.parametrize("tail", ["", "/", "/v1", "/v1/"])
def test_addresses_with_and_without_the_version(lab: tuple[str, State], tail: str) -> None:
    with Client(lab[0] + tail) as client:
        assert client.url == lab[0]
        assert [process.id for process in client.processes()] == ["shells"]


def test_without_address_the_environment_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INTEGUMENT_URL", "http://lab:1")
    with Client() as client:
        assert client.url == "http://lab:1"
    monkeypatch.delenv("INTEGUMENT_URL")
    with Client() as client:
        assert client.url == "http://127.0.0.1:8000"


def test_lists_go_on_over_pages_but_never_to_another_server(client: Client, state: State) -> None:
    ids = [f"{n}" * 36 for n in range(5)]
    for job_id in ids:
        state.add_job(job_id=job_id)
    assert [job.id for job in client.jobs()] == ids
    assert [job.id for job in client.jobs(limit=3)] == ids[:3]
    assert [job.id for job in client.jobs(status="running", process="shells")] == ids
    asked = [seen.path for seen in state.requests("GET", "/v1/jobs")]
    assert asked[3] == "/v1/jobs?limit=3"
    assert asked[4] == "/v1/jobs?status=running&processID=shells"


def test_dismiss_is_never_sent_twice_because_the_second_would_remove_the_job(client: Client, state: State) -> None:
    state.add_job("running")
    path = f"/v1/jobs/{JOB_ID}"
    state.faults[f"DELETE {path}"].append(Drop(after_work=True))
    with pytest.raises(ServerUnreachableError):
        client.dismiss(JOB_ID)
    assert len(state.requests("DELETE", path)) == 1
    with pytest.raises(ArgumentError, match="already dismissed"):
        client.dismiss(JOB_ID)
    assert len(state.requests("DELETE", path)) == 1


def test_dismiss_is_sent_again_when_the_server_did_not_begin(client: Client, state: State) -> None:
    job = state.add_job("running")
    state.faults[f"DELETE /v1/jobs/{JOB_ID}"].append(Refuse(503))
    assert client.dismiss(JOB_ID).status == "dismissed"
    assert job["status"] == "dismissed"


def test_remove_is_for_finished_jobs(client: Client, state: State) -> None:
    job = state.add_job("running")
    with pytest.raises(ArgumentError, match="still running"):
        client.remove(JOB_ID)
    job["status"] = "successful"
    client.remove(JOB_ID)
    assert len(state.requests("DELETE", f"/v1/jobs/{JOB_ID}")) == 1


def test_retry_counts_once_although_its_answer_is_lost(client: Client, state: State) -> None:
    state.add_job("failed")
    state.faults[f"POST /v1/jobs/{JOB_ID}/retry"].append(Drop(after_work=True))
    assert client.retry(JOB_ID).attempt == 2


def test_results_tell_links_from_values(client: Client, state: State) -> None:
    state.add_job("successful")
    results = client.results(JOB_ID)
    assert results.outputs["package"].href == f"/v1/jobs/{JOB_ID}/results/package"
    assert results.values == {"verdict": "simulation_ready"}


def test_shells_uploads_executes_and_waits(client: Client, state: State) -> None:
    state.events = [(1, "done", {"status": "successful"})]
    state.faults[f"GET /v1/jobs/{JOB_ID}"].append(Refuse(503))

    def finish(_event: object) -> None:
        state.jobs[JOB_ID] |= {"status": "successful", "verdict": "simulation_ready"}

    ear = Region("ear", (0, 0, 0), (1, 2, 3), {"fat": 0.3}, blend_mm=5)
    job = client.shells(b"solid", {"fat": 1.0, "average_body": 3.0}, [ear], unit="cm", min_gap_mm=0.05, on_event=finish)
    assert job.ready
    body = json.loads(state.requests("POST", EXECUTION)[0].body)
    assert body == {
        "inputs": {
            "skin": {"href": f"/v1/meshes/{MESH_ID}"},
            "thin_policy": "adapt",
            "layers": [{"name": "fat", "depth_mm": 1.0}, {"name": "average_body", "depth_mm": 3.0}],
            "regions": [
                {"name": "ear", "box_mm": {"min": [0, 0, 0], "max": [1, 2, 3]}, "depths_mm": {"fat": 0.3}, "blend_mm": 5}
            ],
            "min_gap_mm": 0.05,
        }
    }
    assert state.uploads[0]["unit"] == b"cm"


def test_shells_sends_layers_from_outside_inwards(client: Client, state: State) -> None:
    state.events = [(1, "done", {"status": "successful"})]

    def finish(_event: object) -> None:
        state.jobs[JOB_ID] |= {"status": "successful", "verdict": "simulation_ready"}

    client.shells(b"solid", {"fat": "fat_depth_mm"}, outer_layers={"gel": 2.0}, skin_shift_mm=1.0, on_event=finish)
    inputs = json.loads(state.requests("POST", EXECUTION)[0].body)["inputs"]
    assert inputs["layers"] == [
        {"name": "gel", "depth_mm": 2.0, "side": "outside"},
        {"name": "fat", "depth_array": "fat_depth_mm"},
    ]
    assert inputs["skin_shift_mm"] == 1.0


def test_validate_takes_what_the_server_holds_by_reference(client: Client, state: State) -> None:
    state.events = [(1, "done", {})]
    held = client.results(state.add_job("successful")["jobID"]).outputs["package"]
    mesh = client.upload_mesh(b"x")

    def finish(_event: object) -> None:
        state.jobs[JOB_ID] |= {"status": "successful", "verdict": "not_ready"}

    job = client.validate({"a": mesh, "b": held, "c": "/v1/meshes/c", "d": b"new"}, on_event=finish)
    assert not job.ready
    sent = json.loads(state.requests("POST", "/v1/processes/validate/execution")[0].body)["inputs"]["meshes"]
    assert [sent[name]["href"] for name in "abcd"] == [mesh.href, held.href, "/v1/meshes/c", mesh.href]
    assert len(state.uploads) == 2


def test_unknown_keys_of_a_newer_server_are_kept(client: Client, state: State) -> None:
    state.add_job("running", mood="good")
    assert client.job(JOB_ID).as_json()["mood"] == "good"
