"""Rates and quotas as clients meet them."""

from __future__ import annotations

import re
from collections.abc import Iterator

import httpx
import pytest

from store.api_keys import ApiKeys
from store.scope import Scope
from store.settings import Settings
from store.workspaces import Workspaces
from tests.api.live import Live, problem_of, serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Live]:
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("limits"),
        broker_url=shared_valkey.url,
        queue="tests-limits",
        rate_per_s=0.001,  # none comes back while a test runs, however slow the machine
        rate_burst=20,
    )
    with serving(settings) as live:
        yield live


def client_of(live: Live, workspace: str, **quotas: int) -> httpx.Client:
    """A client with a key of a new workspace."""
    made = Workspaces(live.services.db).create(workspace, **quotas)
    key = ApiKeys(live.services.db).create(made.id, "", [Scope.READ, Scope.SUBMIT])
    return httpx.Client(base_url=live.url, headers={"Authorization": f"Bearer {key.text}"}, timeout=60, trust_env=False)


def test_too_many_requests_are_told_when_to_come_again(live: Live) -> None:
    with client_of(live, "busy") as client, client_of(live, "calm") as other:
        answers = [client.get("/v1/jobs") for _ in range(21)]
        assert [answer.status_code for answer in answers] == [200] * 20 + [429]
        assert answers[0].headers["ratelimit-policy"] == '"workspace";q=20;w=20000'
        assert answers[0].headers["ratelimit"] == '"workspace";r=19;t=1000'
        problem = problem_of(answers[-1], 429, "rate.exceeded")
        assert problem["retryable"] is True
        assert problem["facts"]["burst"] == 20
        assert 0 < int(answers[-1].headers["retry-after"]) <= 1000
        assert re.fullmatch('"workspace";r=0;t=[0-9]{5}', answers[-1].headers["ratelimit"])
        assert other.get("/v1/jobs").status_code == 200
        assert httpx.get(f"{live.url}/healthz").status_code == 200


def test_jobs_beyond_the_quota_wait_outside(live: Live) -> None:
    with client_of(live, "many-jobs", quota_jobs=1) as client:
        sent = client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())})
        body = {"inputs": {"meshes": [{"href": sent.headers["location"]}]}}
        first = client.post("/v1/processes/validate/execution", json=body, headers={"Idempotency-Key": "a"})
        assert first.status_code == 201, first.text
        again = client.post("/v1/processes/validate/execution", json=body, headers={"Idempotency-Key": "a"})
        assert again.headers["idempotent-replayed"] == "true"
        second = client.post("/v1/processes/validate/execution", json=body, headers={"Idempotency-Key": "b"})
        problem = problem_of(second, 429, "quota.jobs")
        assert problem["facts"] == {"jobs": 1, "limit": 1}
        assert int(second.headers["retry-after"]) >= 1
        client.delete(first.headers["location"])
        third = client.post("/v1/processes/validate/execution", json=body, headers={"Idempotency-Key": "b"})
        assert third.status_code == 201, "a key is free again after a refusal"


def test_bytes_beyond_the_quota_are_not_kept(live: Live) -> None:
    size = len(binary_stl())
    with client_of(live, "full", quota_bytes=size + 10) as client:
        first = client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())})
        assert first.status_code == 201
        second = client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())})
        problem = problem_of(second, 403, "quota.bytes")
        assert problem["facts"] == {"used_bytes": size, "more_bytes": size, "limit_bytes": size + 10}
        assert problem["retryable"] is False
        tus = {"Tus-Resumable": "1.0.0", "Upload-Length": str(size)}
        problem_of(client.post("/v1/uploads", headers=tus), 403, "quota.bytes")
        assert len(client.get("/v1/meshes").json()["meshes"]) == 1
        client.delete(first.headers["location"])
        assert client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())}).status_code == 201
