"""Every operation of the description, answered as described, and never by a 5xx: for keys of every scope and for none."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from store.api_keys import ApiKeys
from store.scope import Scope
from store.settings import Settings
from store.workspaces import Workspaces
from tests.api.contract import Server, hold, operations
from tests.api.live import serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer

DESCRIPTION = json.loads((Path(__file__).parents[2] / "openapi" / "openapi.json").read_text(encoding="utf-8"))
OPERATIONS = operations(DESCRIPTION)
FEW, MANY = 8, 200


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Server]:
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("contract"),
        broker_url=shared_valkey.url,
        queue="tests-contract",
        event_poll_s=0.05,
        rate_per_s=0,
        quota_jobs=0,
        upload_limit_bytes=64 * 1024,
    )
    with serving(settings) as live:
        workspace = Workspaces(live.services.db).create("lab").id
        keys = ApiKeys(live.services.db)
        text = {scope.value: keys.create(workspace, scope.value, [scope]).text for scope in Scope}
        text["all"] = keys.create(workspace, "all", Scope).text
        client = {"headers": {"Authorization": f"Bearer {text['all']}"}}
        mesh = live.client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())}, **client).json()["id"]
        jobs = (live.successful(workspace=workspace).id, live.successful(workspace=workspace).id)
        processes = tuple(process["id"] for process in live.client.get("/v1/processes", **client).json()["processes"])
        ids = {"mesh_id": (mesh,), "job_id": jobs, "process_id": processes, "output": ("report", "report_html")}
        yield Server(live.url, text | {"nobody": ""}, ids, DESCRIPTION)


@pytest.mark.parametrize("operation", OPERATIONS)
def test_answers_are_as_described(server: Server, operation: str) -> None:
    assert hold(server, operation, FEW, seed_number=5) >= 1


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("operation", OPERATIONS)
def test_answers_are_as_described_many_times(server: Server, operation: str) -> None:
    assert hold(server, operation, MANY, seed_number=6) >= 1
