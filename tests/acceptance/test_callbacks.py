"""From a request over HTTP to a receiver's handler: the API, a worker and a real receiver, checked with its own library."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import httpx
import pytest
from standardwebhooks import Webhook, WebhookVerificationError

from tests.core.io.stl_bytes import binary_stl
from tests.embedded import Embedded, embedded
from tests.worker.receiver import Received, Receiver, receiving

SECRET = "whsec_" + "c2VzYW1lLW9wZW4tc2VzYW1lLW9wZW4tc2VzYW1l"
LIMIT_S = 120.0


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Embedded]:
    """A server that may call this machine."""
    variables = {"INTEGUMENT_CALLBACK_SECRET": SECRET, "INTEGUMENT_CALLBACK_ALLOW": "127.0.0.1"}
    with embedded(tmp_path_factory.mktemp("callbacks") / "data", variables) as server:
        yield server


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    """It takes everything."""
    with receiving() as receiver:
        yield receiver


@pytest.fixture
def client(server: Embedded) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=server.url, timeout=60, trust_env=False) as client:
        yield client


def ask(client: httpx.Client, receiver: Receiver, process: str, inputs: dict[str, Any]) -> str:
    base = f"http://127.0.0.1:{receiver.port}"
    subscriber = {"successUri": f"{base}/success", "inProgressUri": f"{base}/progress", "failedUri": f"{base}/failed"}
    accepted = client.post(f"/v1/processes/{process}/execution", json={"inputs": inputs, "subscriber": subscriber})
    assert accepted.status_code == 201, accepted.text
    return str(accepted.json()["jobID"])


def verified(received: Received) -> dict[str, Any]:
    """Its statusInfo, if the signature is good and young."""
    told: dict[str, Any] = Webhook(SECRET).verify(received.body, received.headers)
    assert told == json.loads(received.body)
    return told


def test_a_job_is_told_of_from_start_to_success(client: httpx.Client, receiver: Receiver) -> None:
    mesh = client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())}, data={"unit": "mm"}).headers["location"]
    job = ask(client, receiver, "validate", {"meshes": [{"href": mesh}]})
    by_path = {one.path: verified(one) for one in receiver.wait_for(2, LIMIT_S)}
    assert {path: (told["jobID"], told["status"]) for path, told in by_path.items()} == {
        "/progress": (job, "running"),
        "/success": (job, "successful"),
    }
    (result,) = [link["href"] for link in by_path["/success"]["links"] if link["href"].endswith("/results")]
    assert httpx.get(result, trust_env=False).status_code == 200, "the link leads back to this server"
    assert len({one.headers["webhook-id"] for one in receiver.received}) == 2
    listed = client.get(f"/v1/jobs/{job}/callbacks").json()["callbacks"]
    assert {one["state"] for one in listed} == {"delivered"}


def test_a_failure_is_told_at_its_own_address(client: httpx.Client, receiver: Receiver) -> None:
    mesh = client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())}, data={"unit": "mm"}).headers["location"]
    job = ask(client, receiver, "shells", {"skin": {"href": mesh}, "layers": [{"name": "fat", "depth_mm": 90.0}]})  # too deep
    deadline = time.monotonic() + LIMIT_S
    while not (ended := [one for one in receiver.received if one.path == "/failed"]):
        assert time.monotonic() < deadline, client.get(f"/v1/jobs/{job}").json()
        time.sleep(0.05)
    failed = verified(ended[0])
    assert (failed["jobID"], failed["status"]) == (job, "failed")
    with pytest.raises(WebhookVerificationError):
        verified(replace(ended[0], body=ended[0].body.replace(b"failed", b"fooled")))
    assert client.delete(f"/v1/jobs/{job}").is_success, "it goes with its callbacks"
    assert client.get(f"/v1/jobs/{job}/callbacks").status_code == 404
