"""Subscribers over HTTP: what is taken, what is refused by name, and what the list of callbacks tells."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from api.schemas.job import StatusInfo
from store.callback import Callback
from store.callbacks import Callbacks
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, problem_of, serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer

SECRET = "whsec_" + "c2VzYW1l" * 4
EVERYWHERE = {name: f"https://lab.example/{name}?token=1" for name in ("successUri", "inProgressUri", "failedUri")}


@pytest.fixture(scope="module")
def telling(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Live]:
    """An API with a secret, and one receiver the operator allows."""
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("callbacks"),
        broker_url=shared_valkey.url,
        queue="tests-callbacks",
        callback_secret=(SECRET,),
        callback_allow=("receiver", "10.1.0.0/16"),
    )
    with serving(settings) as live:
        yield live


@pytest.fixture(scope="module")
def inputs(telling: Live) -> dict[str, Any]:
    """Of a job that would do."""
    return {"meshes": [{"href": telling.mesh_href(binary_stl())}]}


def execute(live: Live, inputs: dict[str, Any], subscriber: object) -> httpx.Response:
    body = {"inputs": inputs, "subscriber": subscriber}
    return live.client.post("/v1/processes/validate/execution", json=body)


@pytest.mark.parametrize(
    ("uri", "code"),
    [
        ("https://lab.example/" + "x" * 2000, "callback.uri_invalid"),
        ("ftp://lab.example/", "callback.uri_invalid"),
        ("lab.example", "callback.uri_invalid"),
        ("https://user:secret@lab.example/", "callback.uri_invalid"),
        ("https://lab.example/#part", "callback.uri_invalid"),
        ("https:///path", "callback.uri_invalid"),
        ("https://lab.example:0/", "callback.uri_invalid"),
        ("https://lab.example:70000/", "callback.uri_invalid"),
        ("https://lab.example\\@10.0.0.1/", "callback.uri_invalid"),
        ("https://lab.example/a b", "callback.uri_invalid"),
        ("https://lab.example/\r\nX: y", "callback.uri_invalid"),
        ("https://löb.example/", "callback.uri_invalid"),
        ("https://2130706433/", "callback.uri_invalid"),
        ("https://0x7f000001/", "callback.uri_invalid"),
        ("https://127.1/", "callback.uri_invalid"),
        ("https://0177.0.0.1/", "callback.uri_invalid"),
        ("https://[fe80::1%25eth0]/", "callback.uri_invalid"),
        ("http://lab.example/", "callback.scheme_refused"),
        ("https://lab.example:8443/", "callback.port_refused"),
        ("https://127.0.0.1/", "callback.host_refused"),
        ("https://[::ffff:127.0.0.1]/", "callback.host_refused"),
        ("https://169.254.169.254/latest/meta-data", "callback.host_refused"),
        ("https://10.2.0.1/", "callback.host_refused"),
        ("https://localhost/", "callback.host_refused"),
        ("https://api.localhost/", "callback.host_refused"),
        ("https://metadata.google.internal/", "callback.host_refused"),
        ("https://postgres/", "callback.host_refused"),
    ],
)
@pytest.mark.parametrize("member", ["successUri", "inProgressUri", "failedUri"])
def test_a_uri_that_will_not_do_is_refused_by_name(
    telling: Live, inputs: dict[str, Any], uri: str, code: str, member: str
) -> None:
    before = telling.client.get("/v1/jobs").json()
    problem = problem_of(execute(telling, inputs, {**EVERYWHERE, member: uri}), 422, code)
    assert problem["facts"] == {"member": member}
    assert problem["detail"].startswith(f"{member}: ")
    assert telling.client.get("/v1/jobs").json() == before


@pytest.mark.parametrize(
    "uri",
    [
        "https://lab.example/hook",
        "https://lab.example:443",
        "HTTPS://LAB.example/",
        "https://93.184.216.34/",
        "https://[2606:2800:220:1::1]/x",
        "http://receiver:8080/",
        "https://receiver/",
        "http://10.1.2.3:9000/hook?job=1",
    ],
)
def test_the_internet_and_what_the_operator_allows_are_taken(telling: Live, inputs: dict[str, Any], uri: str) -> None:
    assert execute(telling, inputs, {"successUri": uri}).status_code == 201


@pytest.mark.parametrize(
    "subscriber", [{}, {"failedUri": "https://lab.example/"}, {**EVERYWHERE, "doneUri": "x"}, "https://x", []]
)
def test_the_form_of_a_subscriber_is_checked(telling: Live, inputs: dict[str, Any], subscriber: object) -> None:
    problem = problem_of(execute(telling, inputs, subscriber), 422, "request.invalid")
    assert all(error["pointer"].startswith("/subscriber") for error in problem["errors"])


def test_without_a_secret_nothing_is_promised(api: Live, mesh_href: str) -> None:
    inputs = {"meshes": [{"href": mesh_href}]}
    problem_of(execute(api, inputs, EVERYWHERE), 422, "callback.not_offered")
    assert execute(api, inputs, None).status_code == 201


def written(live: Live, job_id: str) -> tuple[Callback, ...]:
    return Callbacks(live.services.db).of_job(DEFAULT_WORKSPACE, job_id)


def test_the_body_is_the_status_of_the_job_below_20_kb(telling: Live, inputs: dict[str, Any]) -> None:
    job_id = execute(telling, inputs, EVERYWHERE).json()["jobID"]
    jobs = telling.services.jobs
    job = jobs.claim(job_id, 1, "tests", 60.0)
    assert job is not None
    (started,) = written(telling, job_id)
    shown = telling.client.get(f"/v1/jobs/{job_id}").json()
    told = json.loads(started.body)
    assert (told["status"], started.uri) == ("running", EVERYWHERE["inProgressUri"])
    assert told.items() <= (shown | {"links": told["links"]}).items()
    report = telling.stored(b"{}", "application/json", "report.json")
    assert jobs.finish(job.id, job.lease_token, verdict="not_ready", summary="3 holes", outputs={"report": report}, timings_s={})
    ended = written(telling, job_id)[-1]
    shown, told = telling.client.get(f"/v1/jobs/{job_id}").json(), json.loads(ended.body)
    assert told.items() <= (shown | {"links": told["links"]}).items()
    assert (told["verdict"], ended.uri) == ("not_ready", EVERYWHERE["successUri"])
    StatusInfo.model_validate(told)
    for link in told["links"]:
        assert link in shown["links"]
        assert telling.client.get(link["href"]).status_code == 200
    assert len(ended.body.encode()) < 20_000


def test_callbacks_are_listed_and_replayed(telling: Live, inputs: dict[str, Any]) -> None:
    job_id = execute(telling, inputs, EVERYWHERE).json()["jobID"]
    path = f"/v1/jobs/{job_id}/callbacks"
    assert telling.client.get(path).json() == {"callbacks": []}
    assert telling.services.jobs.claim(job_id, 1, "tests", 60.0) is not None
    callbacks = Callbacks(telling.services.db)
    while (claimed := callbacks.claim(60.0, 10)) is not None and claimed.job_id != job_id:
        pass  # left by the tests before
    assert claimed is not None
    assert callbacks.bury(claimed, 410, "answered 410")
    (dead,) = telling.client.get(path).json()["callbacks"]
    assert (dead["id"], dead["event"], dead["state"]) == (claimed.id, "inProgress", "dead")
    assert (dead["attempts"], dead["lastStatus"], dead["lastError"]) == (1, 410, "answered 410")
    assert "due" not in dead
    replayed = telling.client.post(f"{path}/replay")
    assert replayed.status_code == 202
    (again,) = replayed.json()["callbacks"]
    assert (again["id"], again["state"], again["attempts"]) == (claimed.id, "pending", 0)
    problem_of(telling.client.get(path.replace(job_id, "00000000-0000-4000-8000-000000000000")), 404, "job.not_found")
