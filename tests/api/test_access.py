"""Every route, for every kind of caller, and for what belongs to somebody else."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from sqlalchemy import Connection, event

from api.needed_scope import needed_scope
from api.page_files import read_page
from store.api_keys import ApiKeys
from store.scope import Scope
from store.settings import Settings
from store.workspace import WorkspaceId
from tests.api.access_lab import MISSING, ROUTES, SCOPED, Lab, concrete, open_lab
from tests.api.live import Live, problem_of, serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer

HANDBOOK, HANDBOOK_FILES = "/handbook", "/handbook/{path:path}"
REFUSED = {
    "nothing": "access.key_missing",
    "unknown": "access.key_invalid",
    "mistyped": "access.key_invalid",
    "revoked": "access.key_invalid",
    "expired": "access.key_expired",
}
OPEN = {"/readyz": (503,), HANDBOOK: (308,), HANDBOOK_FILES: (404, 503)}  # no worker is here; perhaps `make docs` was never run
RAW = {"query": "?api_key={0}&access_token={0}&key={0}", "basic": "Basic {0}", "token": "Token {0}", "bare": "{0}"}


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Lab]:
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("access"), broker_url=shared_valkey.url, queue="tests-access", event_poll_s=0.05
    )
    with open_lab(settings) as lab:
        yield lab


@pytest.mark.parametrize(("method", "path"), ROUTES)
@pytest.mark.parametrize("role", REFUSED)
def test_without_a_good_key_nothing_is_served(lab: Lab, method: str, path: str, role: str) -> None:
    response = lab.ask(method, concrete(path, lab.mesh, lab.job), role)
    if needed_scope(method, path) is None:
        assert response.status_code in OPEN.get(path, (200,))
        return
    assert response.status_code == 401
    assert response.headers["www-authenticate"].startswith('Bearer realm="integument"')
    if method != "HEAD":
        problem_of(response, 401, REFUSED[role])


@pytest.mark.parametrize(("method", "path"), ROUTES)
@pytest.mark.parametrize("role", SCOPED)
def test_a_key_is_good_for_its_scope_and_no_other(lab: Lab, method: str, path: str, role: str) -> None:
    response = lab.ask(method, concrete(path), role)
    need = needed_scope(method, path)
    if need in (None, SCOPED[role]):
        assert response.status_code not in (401, 403), response.text
    else:
        assert response.status_code == 403
        assert f'scope="{need}"' in response.headers["www-authenticate"]
        if method != "HEAD":
            problem_of(response, 403, "access.scope_missing")


def test_only_what_is_meant_to_be_open_is_open() -> None:
    open_to_all = {path for method, path in ROUTES if needed_scope(method, path) is None}
    meant = {"/healthz", "/readyz", *read_page(), HANDBOOK, HANDBOOK_FILES}
    assert open_to_all == meant, "supervisors, what the page is made of, and the documentation"
    assert {path for method, path in ROUTES if needed_scope(method, path) is Scope.ADMIN} == {"/metrics"}
    for method, path in ROUTES:
        if path.startswith("/v1"):
            reads = method in ("GET", "HEAD") and not path.startswith("/v1/uploads")
            assert needed_scope(method, path) is (Scope.READ if reads else Scope.SUBMIT)
    assert needed_scope("PATCH", "/v1/uploads/1") is Scope.SUBMIT
    assert needed_scope("GET", "/nowhere") is Scope.READ


@pytest.mark.parametrize(("method", "path"), [route for route in ROUTES if "_id}" in route[1] and "process_id" not in route[1]])
def test_what_is_foreign_is_as_if_it_were_not_there(lab: Lab, method: str, path: str) -> None:
    statements: list[list[str]] = []

    def note(_connection: Connection, _cursor: object, statement: str, *_: object) -> None:
        if threading.current_thread().name != "audit":  # what is written of earlier requests
            statements[-1].append(statement)

    answers = []
    engine = lab.live.services.db.engine
    for _ in range(2):  # its use is noted here, not below; and then its row is read, and known at a glance from then on
        lab.ask("GET", "/v1", "stranger")
    event.listen(engine, "before_cursor_execute", note)
    try:
        for mesh, job, upload, cohort in (
            (lab.mesh, lab.job, lab.upload, lab.cohort),
            (MISSING, MISSING, MISSING, MISSING),
            (lab.mesh, lab.waiting, lab.upload, lab.cohort),
        ):
            statements.append([])
            response = lab.ask(method, concrete(path, mesh, job, upload, cohort), "stranger")
            told = response.text
            for known in (lab.mesh, lab.job, lab.waiting, lab.upload, lab.cohort, response.headers["x-request-id"]):
                told = told.replace(known, MISSING)
            drop = {"x-request-id", "date", "ratelimit"}  # the last counts all requests
            headers = {name: value for name, value in response.headers.items() if name not in drop}
            answers.append((response.status_code, told, headers))
    finally:
        event.remove(engine, "before_cursor_execute", note)
    assert answers[0][0] == 404
    assert answers[0] == answers[1] == answers[2]
    # the same statements in the same order: what is foreign takes no longer than what is not there
    assert statements[0] == statements[1] == statements[2] != []


def test_nothing_of_the_owner_was_touched(lab: Lab) -> None:
    """Runs after the requests above."""
    assert lab.ask("GET", f"/v1/meshes/{lab.mesh}", "owner").status_code == 200
    assert lab.ask("GET", f"/v1/jobs/{lab.job}/results/report", "owner").status_code == 200
    assert lab.ask("GET", f"/v1/uploads/{lab.upload}", "owner").json()["received"] == 0
    assert lab.ask("GET", f"/v1/jobs/{lab.waiting}", "owner").json()["status"] == "accepted"


def test_lists_show_ones_own(lab: Lab) -> None:
    for path, name in (("/v1/jobs", "jobs"), ("/v1/meshes", "meshes")):
        assert len(lab.ask("GET", path, "owner").json()[name]) >= 1
        page = lab.ask("GET", f"{path}?limit=1", "owner").json()
        assert lab.ask("GET", path, "stranger").json()[name] == []
        if page.get("next"):
            assert lab.ask("GET", f"{path}?cursor={page['next']}", "stranger").json()[name] == []


@pytest.mark.parametrize("kind", ["mesh", "result"])
def test_inputs_cannot_refer_to_what_is_foreign(lab: Lab, kind: str) -> None:
    def refusal(mesh: str, job: str) -> dict[str, object]:
        href = f"/v1/meshes/{mesh}" if kind == "mesh" else f"/v1/jobs/{job}/results/report"
        body = {"inputs": {"meshes": [{"href": href}]}}
        response = lab.ask("POST", "/v1/processes/validate/execution", "stranger", json=body)
        problem = problem_of(response, 422, "reference.not_found")
        del problem["request_id"]
        told: dict[str, object] = json.loads(json.dumps(problem).replace(mesh, MISSING).replace(job, MISSING))
        return told

    assert refusal(lab.mesh, lab.job) == refusal(MISSING, MISSING) == refusal(lab.mesh, lab.waiting)


def test_an_idempotency_key_replays_within_its_workspace_alone(lab: Lab) -> None:
    def execute(role: str) -> httpx.Response:
        headers = {"Authorization": f"Bearer {lab.keys[role]}", "Idempotency-Key": "shared"}
        made = lab.live.client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())}, headers=headers)
        assert made.status_code == 201, made.text
        return made

    first, again, other = execute("owner"), execute("owner"), execute("stranger")
    assert first.json()["id"] == again.json()["id"] != other.json()["id"]
    assert again.headers["idempotent-replayed"] == "true"
    assert "idempotent-replayed" not in other.headers
    lab.ask("DELETE", f"/v1/meshes/{other.json()['id']}", "stranger")


@pytest.mark.parametrize("form", RAW)
def test_a_key_travels_in_one_header_only(lab: Lab, form: str) -> None:
    key, client = lab.keys["owner"], lab.live.client
    if form == "query":
        problem_of(client.get("/v1/jobs" + RAW[form].format(key)), 401, "access.key_missing")
    else:
        problem_of(client.get("/v1/jobs", headers={"Authorization": RAW[form].format(key)}), 401, "access.key_invalid")
    two = [("Authorization", f"Bearer {key}"), ("Authorization", f"Bearer {key}")]
    problem_of(client.get("/v1/jobs", headers=two), 401, "access.key_invalid")
    assert client.get("/v1/jobs", headers={"authorization": f"bearer  {key}"}).status_code == 200


def test_nothing_is_read_of_an_upload_before_the_key(lab: Lab) -> None:
    before = lab.live.blob_names()
    response = lab.live.client.post("/v1/meshes", files={"file": ("skin.stl", b"x" * 3_000_000)})
    problem_of(response, 401, "access.key_missing")
    assert lab.live.incoming() == []
    assert lab.live.blob_names() == before


def test_a_stream_ends_when_its_key_is_revoked(lab: Lab) -> None:
    services = lab.live.services
    keys = ApiKeys(services.db)
    issued = keys.create(WorkspaceId("lab-a"), "listener", [Scope.READ])
    headers = {"Authorization": f"Bearer {issued.text}"}
    with lab.live.client.stream("GET", f"/v1/jobs/{lab.waiting}/events", headers=headers, timeout=20) as stream:
        lines = stream.iter_lines()
        next(lines)
        keys.revoke(issued.key.id)
        assert not any(line.startswith("event: done") for line in lines)


def test_the_first_key_closes_a_server_that_was_open(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-first-key")
    with serving(settings) as live:
        assert live.client.get("/v1/jobs").status_code == 200
        assert live.client.get("/metrics").status_code == 200
        # while there is no key none is looked at
        assert live.client.get("/v1/jobs", headers={"Authorization": "Bearer nonsense"}).status_code == 200
        keys = ApiKeys(live.services.db)
        issued = keys.create(WorkspaceId("default"), "", [Scope.READ])
        problem_of(live.client.get("/v1/jobs"), 401, "access.key_missing")
        assert live.client.get("/v1/jobs", headers={"Authorization": f"Bearer {issued.text}"}).status_code == 200
        keys.revoke(issued.key.id)
        problem_of(live.client.get("/v1/jobs"), 401, "access.key_missing")
    with serving(settings) as live:
        problem_of(live.client.get("/v1/jobs"), 401, "access.key_missing")


def test_a_server_may_ask_for_keys_from_the_start(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-first-key", require_keys="true")
    with serving(settings) as live:
        problem_of(live.client.get("/v1/jobs"), 401, "access.key_missing")
        assert live.client.get("/healthz").status_code == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://localhost", ""])
def test_a_page_of_another_server_cannot_act(api: Live, origin: str) -> None:
    """Without keys nothing else would stop a form that posts to 127.0.0.1."""
    sent = {"files": {"file": ("skin.stl", binary_stl())}, "headers": {"Origin": origin}}
    problem_of(api.client.post("/v1/meshes", **sent), 403, "request.origin_refused")  # type: ignore[arg-type]
    assert api.client.get("/v1/meshes", headers={"Origin": origin}).status_code == 200
    own = {"Origin": api.url}
    assert api.client.post("/v1/meshes", files={"file": ("skin.stl", binary_stl())}, headers=own).status_code == 201


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80", "[::1", "a b", ""])
def test_a_rebound_name_gets_nothing_even_with_a_key(lab: Lab, host: str) -> None:
    headers = {"Host": host, "Authorization": f"Bearer {lab.keys['owner']}"}
    response = lab.live.client.get("/v1/jobs", headers=headers)
    assert response.status_code == 400
    assert lab.job not in response.text
