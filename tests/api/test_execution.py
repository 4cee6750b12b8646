"""Executions: what is accepted, what is refused and why, and that the workers hear of it."""

from __future__ import annotations

import json
import threading
import time
from pathlib import Path
from typing import Any
from uuid import uuid4

import pytest
import redis

from core.errors import InputError
from store.job import JobFailure, JobStatus
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.conftest import QUEUE
from tests.api.live import Live, problem_of, serving
from tests.valkey import ValkeyServer

HEARD = f"{QUEUE}.fast"

LAYERS = [
    {"name": "fat", "depth_mm": 1.0, "side": "inside"},
    {"name": "average_body", "depth_mm": 3.0, "side": "inside"},
]
NOWHERE = "/v1/meshes/00000000-0000-4000-8000-000000000000"


def test_an_accepted_job_is_described_and_announced(api: Live, mesh_href: str, shared_valkey: ValkeyServer) -> None:
    broker = redis.Redis(unix_socket_path=str(shared_valkey.socket_path))
    broker.delete(HEARD)
    response = api.execute("shells", {"skin": {"href": mesh_href}})
    assert response.status_code == 201
    told = response.json()
    assert response.headers["Location"] == f"/v1/jobs/{told['jobID']}"
    assert (told["type"], told["processID"], told["status"], told["progress"]) == ("process", "shells", "accepted", 0)
    assert told["attempt"] == 1
    assert told["queuePosition"] >= 1
    assert told["message"]
    assert [link["href"] for link in told["links"] if link["rel"] == "self"] == [api.url + response.headers["Location"]]
    job = api.announced(told["jobID"])
    assert job.inputs["layers"] == LAYERS, "defaults are written down, so a later version cannot change the job"
    assert list(job.mesh_inputs) == [mesh_href]
    assert broker.llen(HEARD) == 1
    message = json.loads(broker.lindex(HEARD, 0))
    assert told["jobID"] in json.dumps(message["headers"])


def test_an_absolute_link_counts_by_its_path(api: Live, mesh_href: str) -> None:
    told = api.execute("validate", {"meshes": {"skin": {"href": "http://elsewhere.example:1" + mesh_href}}}).json()
    job = api.services.jobs.get(DEFAULT_WORKSPACE, told["jobID"])
    assert job.inputs["meshes"] == {"skin": {"href": mesh_href}}
    assert list(job.mesh_inputs) == [mesh_href]


def test_a_result_of_a_job_is_an_input(api: Live) -> None:
    job = api.successful({"fat": (b"solid", "model/stl", "fat.stl"), "report": (b"{}", "application/json", "report.json")})
    results = api.client.get(f"/v1/jobs/{job.id}/results").json()
    assert api.execute("validate", {"meshes": results["fat"]["href"] and {"href": results["fat"]["href"]}}).status_code == 201
    problem = problem_of(api.execute("validate", {"meshes": {"href": results["report"]["href"]}}), 422, "reference.not_a_mesh")
    assert "application/json" in problem["detail"]
    missing = problem_of(
        api.execute("validate", {"meshes": {"href": f"/v1/jobs/{job.id}/results/skin"}}), 422, "reference.not_found"
    )
    assert "fat, report" in missing["detail"]


def test_a_result_of_an_unfinished_or_failed_job_is_not(api: Live) -> None:
    failure = JobFailure.of(InputError("skin.not_closed", "the skin has 3 open edges", edges=3))
    for job in (api.running(), api.failed(failure)):
        reference = {"href": f"/v1/jobs/{job.id}/results/fat"}
        problem = problem_of(api.execute("validate", {"meshes": reference}), 422, "reference.not_ready")
        assert problem["facts"]["job"] == job.id


def skin_with(**inputs: Any) -> dict[str, Any]:
    return {"skin": {"href": NOWHERE}, **inputs}


def layers(*depths: Any) -> list[dict[str, Any]]:
    return [{"name": f"layer{number}", "depth_mm": depth} for number, depth in enumerate(depths)]


BOX = {"min": [0, 0, 0], "max": [1, 1, 1]}
# inputs, code, what the detail must say, pointers of the violations
REFUSED: dict[str, tuple[dict[str, Any], str, str, list[str]]] = {
    "layers not increasing": (
        skin_with(layers=layers(3.0, 1.0)),
        "inputs.invalid",
        "got layer0 3 mm inside, layer1 1 mm inside",
        ["/inputs"],
    ),
    "layers equal": (
        skin_with(layers=layers(1.0, 1.0)),
        "inputs.invalid",
        "got layer0 1 mm inside, layer1 1 mm inside",
        ["/inputs"],
    ),
    "negative": (skin_with(layers=layers(-1.0)), "inputs.invalid", "got -1.0", ["/inputs/layers/0/depth_mm"]),
    "zero": (skin_with(layers=layers(0)), "inputs.invalid", "got 0", ["/inputs/layers/0/depth_mm"]),
    "beyond any body": (skin_with(layers=layers(1, 2000.0)), "inputs.invalid", "got 2000.0", ["/inputs/layers/1/depth_mm"]),
    "a word": (skin_with(layers=layers("deep")), "inputs.invalid", "got 'deep'", ["/inputs/layers/0/depth_mm"]),
    "no layers": (skin_with(layers=[]), "inputs.invalid", "at least 1", ["/inputs/layers"]),
    "two alike": (skin_with(layers=[*layers(1.0), *layers(2.0)]), "inputs.invalid", "layer0", ["/inputs"]),
    "unknown key": (skin_with(colour="red"), "inputs.unknown_key", "/inputs/colour", ["/inputs/colour"]),
    "unknown keys below": (
        skin_with(layers=[{"name": "fat", "depth_mm": 1, "depth_cm": 1}]),
        "inputs.unknown_key",
        "depth_cm",
        ["/inputs/layers/0/depth_cm"],
    ),
    "unknown and wrong": (
        skin_with(colour="red", min_gap_mm=-1),
        "inputs.invalid",
        "-1",
        ["/inputs/min_gap_mm", "/inputs/colour"],
    ),
    "key with slash": (skin_with(**{"a/b~c": 1}), "inputs.unknown_key", "", ["/inputs/a~1b~0c"]),
    "no skin": ({}, "inputs.invalid", "required", ["/inputs/skin"]),
    "not a reference": ({"skin": "/v1/meshes/x"}, "inputs.invalid", "", ["/inputs/skin"]),
    "foreign link": ({"skin": {"href": "https://elsewhere.example/skin.stl"}}, "inputs.invalid", "", ["/inputs/skin/href"]),
    "region of no layer": (
        skin_with(regions=[{"name": "ear", "box_mm": BOX, "depths_mm": {"bone": 1}}]),
        "inputs.invalid",
        "['bone']",
        ["/inputs"],
    ),
    "box without volume": (
        skin_with(regions=[{"name": "ear", "box_mm": {"min": [0, 0, 0], "max": [1, 0, 1]}, "depths_mm": {"fat": 1}}]),
        "inputs.invalid",
        "(1.0, 0.0, 1.0)",
        ["/inputs/regions/0/box_mm"],
    ),
    "missing mesh": (skin_with(), "reference.not_found", NOWHERE, []),
    "number too large to be one": (skin_with(min_gap_mm=10**400), "inputs.invalid", "", ["/inputs/min_gap_mm"]),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_inputs_are_refused_by_name_and_place(api: Live, case: str) -> None:
    inputs, code, said, pointers = REFUSED[case]
    before = api.services.backlog.count().jobs
    problem = problem_of(api.execute("shells", inputs), 422, code)
    assert said in problem["detail"]
    assert [violation["pointer"] for violation in problem["errors"]] == pointers
    assert api.services.backlog.count().jobs == before


@pytest.mark.parametrize(
    ("meshes", "code", "pointers"),
    [
        ({"href": NOWHERE, "colour": "red"}, "inputs.unknown_key", ["/inputs/meshes/colour"]),
        ({"href": "/v1/meshes/x"}, "inputs.invalid", ["/inputs/meshes/href"]),
        ([{"href": NOWHERE}, {"href": "/v2"}], "inputs.invalid", ["/inputs/meshes/1/href"]),
        ([], "inputs.invalid", ["/inputs/meshes"]),
        ({"skin": {"href": NOWHERE}, "no good name": {"href": NOWHERE}}, "inputs.invalid", ["/inputs/meshes/no good name"]),
        ({"skin": {"href": NOWHERE}}, "reference.not_found", []),
    ],
)
def test_inputs_with_several_forms_are_judged_by_the_form_sent(api: Live, meshes: Any, code: str, pointers: list[str]) -> None:
    problem = problem_of(api.execute("validate", {"meshes": meshes}), 422, code)
    assert [violation["pointer"] for violation in problem["errors"]] == pointers


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_numbers_json_does_not_have_are_refused(api: Live, number: str) -> None:
    body = f'{{"inputs": {{"skin": {{"href": "{NOWHERE}"}}, "layers": [{{"name": "fat", "depth_mm": {number}}}]}}}}'
    response = api.client.post("/v1/processes/shells/execution", content=body, headers={"Content-Type": "application/json"})
    problem = problem_of(response, 422, "inputs.invalid")
    assert problem["errors"][0]["pointer"] == "/inputs/layers/0/depth_mm"


BODIES = {
    "not JSON": (b"{inputs}", "application/json", 400, "request.malformed"),
    "cut off": (b'{"inputs": {', "application/json", 400, "request.malformed"),
    "nothing": (b"", "application/json", 422, "request.invalid"),
    "a list": (b"[]", "application/json", 422, "request.invalid"),
    "too deep": (b"[" * 200_000, "application/json", 400, "request.malformed"),
    "too long a number": (b'{"inputs": {"a": ' + b"9" * 5000 + b"}}", "application/json", 400, "request.malformed"),
    "other type": (b"<inputs/>", "text/xml", 415, "request.media_type"),
    "no type": (b'{"inputs": {}}', "", 415, "request.media_type"),
    "too large": (b'{"inputs": {"a": "' + b"a" * 2**20 + b'"}}', "application/json", 413, "request.too_large"),
    "unknown key": (b'{"inputs": {}, "mode": "async"}', "application/json", 422, "request.invalid"),
    "raw": (b'{"inputs": {}, "response": "raw"}', "application/json", 422, "request.invalid"),
    "by value": (
        b'{"inputs": {}, "outputs": {"report": {"transmissionMode": "value"}}}',
        "application/json",
        422,
        "request.invalid",
    ),
    "lone surrogate": (b'{"inputs": {"\\ud800": "\\udc00"}}', "application/json", 422, "inputs.invalid"),
}


@pytest.mark.parametrize("case", BODIES)
def test_bad_bodies_are_refused(api: Live, case: str) -> None:
    body, media_type, status, code = BODIES[case]
    headers = {"Content-Type": media_type} if media_type else {}
    problem_of(api.client.post("/v1/processes/shells/execution", content=body, headers=headers), status, code)


def test_an_unknown_process_is_named_with_those_there_are(api: Live) -> None:
    for response in (api.execute("smoothen", {}), api.client.get("/v1/processes/smoothen")):
        problem = problem_of(response, 404, "process.not_found")
        assert problem["type"] == "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/no-such-process"
        assert "'smoothen'" in problem["detail"]
        assert "validate, shells" in problem["detail"]


def test_outputs_may_be_named_if_the_job_makes_them(api: Live, mesh_href: str) -> None:
    def ask(*names: str) -> Any:
        body = {"inputs": {"skin": {"href": mesh_href}}, "outputs": {name: {} for name in names}, "response": "document"}
        return api.client.post("/v1/processes/shells/execution", json=body)

    assert ask("package", "average_body").status_code == 201
    problem = problem_of(ask("package", "bone"), 422, "outputs.unknown")
    assert "bone" in problem["detail"]


def test_one_key_makes_one_job(api: Live, mesh_href: str) -> None:
    inputs = {"meshes": {"href": mesh_href}}
    key = str(uuid4())
    first = api.execute("validate", inputs, Idempotency_Key=key)
    second = api.execute("validate", inputs, Idempotency_Key=key)
    assert first.json()["jobID"] == second.json()["jobID"]
    assert second.status_code == 201
    assert second.headers["Location"] == first.headers["Location"]
    assert second.headers["Idempotent-Replayed"] == "true"
    problem_of(api.execute("validate", {**inputs, "min_gap_mm": 1}, Idempotency_Key=key), 422, "idempotency.mismatch")
    problem_of(api.execute("shells", {"skin": {"href": mesh_href}}, Idempotency_Key=key), 422, "idempotency.mismatch")
    for bad in ("", "x" * 256, "two words"):
        problem_of(api.execute("validate", inputs, Idempotency_Key=bad), 400, "idempotency.key_invalid")


def test_a_refused_execution_frees_its_key(api: Live, mesh_href: str) -> None:
    key = str(uuid4())
    problem_of(api.execute("validate", {"meshes": {"href": NOWHERE}}, Idempotency_Key=key), 422, "reference.not_found")
    assert api.execute("validate", {"meshes": {"href": mesh_href}}, Idempotency_Key=key).status_code == 201


def test_many_at_once_under_one_key_make_one_job(api: Live, mesh_href: str) -> None:
    key, answers = str(uuid4()), []

    def send() -> None:
        answers.append(api.execute("validate", {"meshes": {"href": mesh_href}}, Idempotency_Key=key))

    threads = [threading.Thread(target=send) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [answer.status_code for answer in answers] == [201] * 8
    assert len({answer.json()["jobID"] for answer in answers}) == 1
    assert sum("Idempotent-Replayed" in answer.headers for answer in answers) == 7


def test_preferences_are_honoured_and_told(api: Live, mesh_href: str) -> None:
    inputs = {"meshes": {"href": mesh_href}}
    assert "Preference-Applied" not in api.execute("validate", inputs).headers
    assert api.execute("validate", inputs, Prefer="respond-async").headers["Preference-Applied"] == "respond-async"
    started = time.monotonic()
    waited = api.execute("validate", inputs, Prefer="respond-async, wait=1")
    assert 1.0 <= time.monotonic() - started < 5.0
    assert waited.status_code == 201
    assert waited.headers["Preference-Applied"] == "respond-async, wait=1"
    assert waited.json()["status"] == "accepted"


def test_waiting_ends_with_the_job(api: Live, mesh_href: str) -> None:
    answers = []

    def send() -> None:
        answers.append(api.execute("validate", {"meshes": {"href": mesh_href}}, Prefer="wait=20", Idempotency_Key=key))

    key = str(uuid4())
    before = {job.id for job in api.services.jobs.list(DEFAULT_WORKSPACE, limit=1000).items}
    started = time.monotonic()
    thread = threading.Thread(target=send)
    thread.start()
    made: list[str] = []
    while not made and time.monotonic() - started < 10:
        made = [job.id for job in api.services.jobs.list(DEFAULT_WORKSPACE, limit=1000).items if job.id not in before]
    job = api.services.jobs.claim(made[0], 1, "tests", 60.0)
    assert job is not None
    api.services.jobs.finish(job.id, job.lease_token, verdict="not_ready", summary="1 error", outputs={}, timings_s={})
    thread.join()
    assert time.monotonic() - started < 10
    assert (answers[0].json()["status"], answers[0].json()["verdict"]) == ("successful", "not_ready")


def test_a_silent_broker_does_not_concern_the_client(tmp_path: Path, stl: bytes) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=f"redis+socket://{tmp_path}/nobody.sock")
    with serving(settings) as live:
        told = live.execute("validate", {"meshes": {"href": live.mesh_href(stl)}}).json()
        job = live.services.jobs.get(DEFAULT_WORKSPACE, told["jobID"])
        assert (job.status, job.rung_at) == (JobStatus.ACCEPTED, None)
        assert live.services.jobs.due_to_ring(30.0) == [(job.id, 1)]


def test_outputs_of_surfaces_are_named_after_what_came(api: Live, mesh_href: str) -> None:
    def ask(subject: dict[str, Any], *names: str) -> Any:
        body = {"inputs": {**subject, "iterations": 1}, "outputs": {name: {} for name in names}}
        return api.client.post("/v1/processes/smooth/execution", json=body)

    reference = {"href": mesh_href}
    made = api.successful({"package": (b"PK", "application/zip", "package.zip")})
    package = {"package": {"href": f"/v1/jobs/{made.id}/results/package"}}
    assert ask({"mesh": reference}, "mesh", "report").status_code == 201
    assert ask({"meshes": {"fat": reference}}, "package", "fat").status_code == 201
    assert ask(package, "anything").status_code == 201  # what a package holds is known when it is read
    assert "mesh, report" in problem_of(ask({"mesh": reference}, "package"), 422, "outputs.unknown")["detail"]
    assert "package, report" in problem_of(ask({"meshes": {"fat": reference}}, "mesh"), 422, "outputs.unknown")["detail"]


def test_a_package_is_resolved_and_bound_to_its_bytes(api: Live, mesh_href: str) -> None:
    outputs = {"package": (b"PK", "application/zip", "package.zip"), "skin": (b"solid", "model/stl", "skin.stl")}
    results = f"/v1/jobs/{api.successful(outputs).id}/results"
    told = api.execute("heal", {"package": {"href": f"http://elsewhere.example{results}/package"}})
    assert told.status_code == 201
    job = api.services.jobs.get(DEFAULT_WORKSPACE, told.json()["jobID"])
    assert job.inputs["package"] == {"href": f"{results}/package"}
    assert job.mesh_inputs[f"{results}/package"].media_type == "application/zip"
    problem_of(api.execute("heal", {"package": {"href": f"{results}/skin"}}), 422, "reference.not_a_package")
    problem_of(api.execute("heal", {"mesh": {"href": f"{results}/package"}}), 422, "reference.not_a_mesh")
    problem_of(api.execute("heal", {"package": {"href": mesh_href}}), 422, "inputs.invalid")
