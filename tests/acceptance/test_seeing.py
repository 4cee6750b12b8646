"""The embedded server as an operator sees it: one trace from request to stages, JSON lines, metrics, and no secret anywhere."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from tests.acceptance.otlp_receiver import OtlpReceiver, otlp_receiver
from tests.core.io.stl_bytes import binary_stl
from tests.embedded import Embedded, embedded

SECRET = "whsec_" + "c2VzYW1lLW9wZW4tc2VzYW1lLW9wZW4tc2VzYW1l"
TRACE, CALLER = "4bf92f3577b34da6a3ce929d0e0e4736", "00f067aa0ba902b7"


@pytest.fixture(scope="module")
def receiver() -> Iterator[OtlpReceiver]:
    """A collector."""
    with otlp_receiver() as receiver:
        yield receiver


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory, receiver: OtlpReceiver) -> Iterator[Embedded]:
    """A server that sends its traces there."""
    variables = {
        "OTEL_EXPORTER_OTLP_ENDPOINT": receiver.url,
        "OTEL_BSP_SCHEDULE_DELAY": "200",
        "INTEGUMENT_CALLBACK_SECRET": SECRET,
    }
    with embedded(tmp_path_factory.mktemp("seeing") / "data", variables) as server:
        yield server


@pytest.fixture(scope="module")
def job(server: Embedded) -> dict[str, Any]:
    """A finished job that was asked for within a trace of its client's."""
    with httpx.Client(base_url=server.url, timeout=60, trust_env=False) as client:
        mesh = client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())}, data={"unit": "mm"}).headers["location"]
        accepted = client.post(
            "/v1/processes/validate/execution",
            json={"inputs": {"meshes": [{"href": mesh}]}},
            headers={"traceparent": f"00-{TRACE}-{CALLER}-01", "X-Request-ID": "seen-7"},
        )
        assert accepted.status_code == 201, accepted.text
        deadline = time.monotonic() + 120
        while (told := client.get(f"/v1/jobs/{accepted.json()['jobID']}").json())["status"] in ("accepted", "running"):
            assert time.monotonic() < deadline, told
            time.sleep(0.1)
    assert told["status"] == "successful", told
    return dict(told)


def until(condition: Callable[[], Any]) -> Any:
    deadline = time.monotonic() + 60
    while not (found := condition()):
        assert time.monotonic() < deadline
        time.sleep(0.1)
    return found


def test_request_attempt_and_stages_are_one_trace(job: dict[str, Any], receiver: OtlpReceiver) -> None:
    until(lambda: [span for span in receiver.spans if span.name == "run validate"])
    until(lambda: [span for span in receiver.spans if span.name.startswith("POST /v1/processes")])
    trace = [span for span in receiver.spans if span.trace == TRACE]
    (request,) = [span for span in trace if span.service == "integument-api"]
    assert request.name == "POST /v1/processes/{process_id}/execution"
    assert request.parent == CALLER
    assert request.attributes["http.response.status_code"] == 201
    assert request.attributes["integument.request_id"] == "seen-7"
    (attempt,) = [span for span in trace if span.name == "run validate"]
    assert (attempt.service, attempt.parent) == ("integument-worker", request.id)
    assert attempt.attributes["integument.job_id"] == job["jobID"]
    assert attempt.attributes["integument.attempt"] == 1
    stages = [span for span in trace if span.parent == attempt.id]
    assert [stage.name for stage in stages if stage.name in ("stage validate", "stage store")] == [
        "stage validate",
        "stage store",
    ]
    assert len(trace) == 2 + len(stages)
    assert not any(span.failed for span in trace)


def test_every_line_is_json_and_says_what_it_is_about(job: dict[str, Any], server: Embedded) -> None:
    lines = {}
    for part in ("api", "worker"):
        lines[part] = [json.loads(line) for line in server.log(part).splitlines()]
        assert all({"ts", "level", "event", "logger", "message"} <= set(line) for line in lines[part])
    (accepted,) = [line for line in lines["api"] if line["event"] == "http_request" and line["path"].endswith("/execution")]
    assert (accepted["request_id"], accepted["workspace"], accepted["status"]) == ("seen-7", "default", 201)
    assert accepted["trace_id"] == TRACE
    (audited,) = [line for line in lines["api"] if line["event"] == "audit" and line.get("request_id") == "seen-7"]
    assert audited["outcome"] == "done"
    about = [line for line in lines["worker"] if line.get("job_id") == job["jobID"]]
    assert {"job_claimed", "stage_ended", "job_ended"} <= {line["event"] for line in about}
    assert all((line["attempt"], line["workspace"], line["trace_id"]) == (1, "default", TRACE) for line in about)
    assert {"validate", "store"} <= {line["stage"] for line in about if line["event"] == "stage_ended"}
    assert any(line["logger"] == "sandbox.nursery" for line in lines["worker"]), "children, too"


def test_metrics_tell_of_the_job_and_its_worker(job: dict[str, Any], server: Embedded) -> None:
    def told() -> str:
        return httpx.get(f"{server.url}/metrics", trust_env=False).text

    text = until(
        lambda: text if 'integument_jobs_ended_total{process="validate",status="successful"} 1.0' in (text := told()) else ""
    )
    assert 'integument_workers{state="alive"} 1.0' in text
    assert "integument_backlog 0.0" in text
    assert 'integument_stage_seconds_count{process="validate",stage="validate"} 1.0' in text
    assert 'integument_job_input_faces_sum{process="validate"} 4.0' in text
    assert httpx.get(f"{server.url}/readyz", trust_env=False).status_code == 200


def test_no_secret_is_in_any_log(job: dict[str, Any], server: Embedded) -> None:
    logs = b"".join(path.read_bytes() for path in (Path(server.data_dir) / "logs").iterdir())
    assert logs
    assert SECRET.removeprefix("whsec_").encode() not in logs
