"""Whatever goes wrong, the answer is a problem of one shape, and OpenAPI says which to expect."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import httpx
import pytest

from api.app import create_app
from api.openapi import build_openapi
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, problem_of, serving

TUS = {"Tus-Resumable": "1.0.0", "Upload-Offset": "0"}
METHODS = ("GET", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")


@pytest.fixture(scope="module")
def paths(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """Path -> method -> operation, of the application itself."""
    app = create_app(Settings(data_dir=tmp_path_factory.mktemp("openapi")))
    found: dict[str, dict[str, Any]] = build_openapi(app)["paths"]
    return found


def filled(path: str, value: str) -> str:
    """The path with `value` for every parameter."""
    while "{" in path:
        start, end = path.index("{"), path.index("}")
        path = path[:start] + value + path[end + 1 :]
    return path


def test_methods_that_are_not_offered_are_problems_that_name_those_that_are(api: Live, paths: dict[str, dict[str, Any]]) -> None:
    asked = 0
    for path, operations in paths.items():
        for method in METHODS:
            if method.lower() not in operations:
                response = api.client.request(method, filled(path, "x"))
                problem_of(response, 405, "method.not_allowed")
                allowed = {name.strip() for name in response.headers["allow"].split(",")}
                assert {name.upper() for name in operations} >= allowed - {"HEAD"}
                asked += 1
    assert asked > 80


def test_things_that_are_not_there_are_problems_as_declared(api: Live, paths: dict[str, dict[str, Any]]) -> None:
    asked = 0
    for path, operations in paths.items():
        if "{" not in path:
            continue
        for method, operation in operations.items():
            body = {"json": {"inputs": {}}} if method == "post" and not path.startswith("/v1/uploads") else {}
            response = api.client.request(method, filled(path, "nonsense"), headers=TUS, **body)
            problem = problem_of(response, 404, response.json()["code"])
            assert problem["code"] in (
                "cohort.not_found",
                "job.not_found",
                "mesh.not_found",
                "process.not_found",
                "upload.not_found",
            )
            assert "404" in operation["responses"]
            asked += 1
    assert asked >= 19, "every route with an id in its path"


def test_every_problem_is_declared_as_one(paths: dict[str, dict[str, Any]]) -> None:
    for operations in paths.values():
        for operation in operations.values():
            for status, response in operation["responses"].items():
                if int(status) >= 400:
                    assert list(response["content"]) == ["application/problem+json"]
                    schema = response["content"]["application/problem+json"]["schema"]
                    assert schema == {"$ref": "#/components/schemas/Problem"}
            assert {"400", "500"} <= set(operation["responses"])
            assert operation["operationId"].isalnum()
            assert len(operation["tags"]) == 1
            assert operation["description"]


@pytest.mark.parametrize(
    "path", ["/assets/nope.js", "/v2", "/v1/jobs/", "/docs", "/redoc", "/openapi.json", "/v1/..%2fhealthz", "/%00"]
)
def test_unknown_paths_are_problems(api: Live, path: str) -> None:
    problem_of(httpx.get(api.url + path), 404, "route.not_found")


def test_a_request_id_comes_back_if_it_is_fit_for_a_log(api: Live) -> None:
    for sent in ("abc-1.2_3", "a" * 64):
        assert api.client.get("/healthz", headers={"X-Request-ID": sent}).headers["x-request-id"] == sent
    for sent in ("", "a" * 65, "two words", "<script>", "-x", "\u00e4".encode()):
        answer = api.client.get("/nope", headers=[(b"X-Request-ID", sent if isinstance(sent, bytes) else sent.encode())])
        problem_of(answer, 404, "route.not_found")
        assert len(answer.headers["x-request-id"]) == 32
    first, second = (api.client.get("/healthz").headers["x-request-id"] for _ in range(2))
    assert first != second


def test_a_bug_is_a_problem_that_tells_nothing_but_where_to_look(api: Live, caplog: pytest.LogCaptureFixture) -> None:
    job = api.running()
    api.services.jobs.finish(job.id, job.lease_token, verdict="who knows", summary="", outputs={}, timings_s={})
    with caplog.at_level(logging.ERROR):
        response = api.client.get(f"/v1/jobs/{job.id}", headers={"X-Request-ID": "look-for-me"})
    api.services.jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    problem = problem_of(response, 500, "internal.unexpected")
    assert problem["retryable"]
    assert "look-for-me" in problem["detail"]
    assert "verdict" not in problem["detail"]
    assert response.headers["x-content-type-options"] == "nosniff"
    (logged,) = (record for record in caplog.records if "look-for-me" in record.getMessage())
    assert logged.exc_info is not None


def test_a_database_that_does_not_answer_is_worth_another_try(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path)) as live:
        with live.services.db.session() as session:
            session.connection().exec_driver_sql("ALTER TABLE jobs RENAME TO elsewhere")
        response = live.client.get("/v1/jobs")
        assert problem_of(response, 503, "database.unavailable")["retryable"]
        assert response.headers["retry-after"] == "1"


@pytest.mark.parametrize(
    "host",
    ["evil.example", "127.0.0.1.evil.example", "localhost:80:80", "", "localhost/", "[::1", "a" * 300, "127.0.0.1, evil.example"],
)
def test_other_host_names_are_refused(api: Live, host: str) -> None:
    """A page that makes its own name point here must get nothing: not the jobs, not even a link."""
    response = api.client.get("/v1/jobs", headers={"Host": host})
    if host == "":
        assert response.status_code == 400
        return
    problem = problem_of(response, 400, "request.host_refused")
    assert "jobs" not in problem["detail"]


@pytest.mark.parametrize("host", ["localhost", "LOCALHOST:1234", "127.0.0.1", "[::1]:8000"])
def test_loopback_names_are_answered_with_links_that_lead_back(api: Live, host: str) -> None:
    links = api.client.get("/v1", headers={"Host": host}).json()["links"]
    assert {httpx.URL(link["href"]).host for link in links} == {httpx.URL(f"http://{host}").host}


def test_host_names_can_be_allowed(tmp_path: Path) -> None:
    with serving(Settings(data_dir=tmp_path / "one", allowed_hosts=("mesh.lab.example",))) as live:
        assert live.client.get("/healthz", headers={"Host": "Mesh.Lab.Example:8000"}).status_code == 200
        assert live.client.get("/healthz", headers={"Host": "other.lab.example"}).status_code == 400
    with serving(Settings(data_dir=tmp_path / "any", allowed_hosts=("*",))) as live:
        assert live.client.get("/healthz", headers={"Host": "whatever.example"}).status_code == 200


def test_every_answer_carries_the_security_headers(api: Live, mesh_href: str) -> None:
    answers = [
        api.client.get("/v1"),
        api.client.get("/nope"),
        api.client.get(f"{mesh_href}/file"),
        api.client.get("/healthz", headers={"Host": "evil.example"}),
        api.client.get(f"/v1/jobs/{api.successful().id}/events"),
    ]
    for answer in answers:
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["content-security-policy"].startswith("default-src 'none'")
        assert answer.headers["referrer-policy"] == "no-referrer"
        assert answer.headers["cross-origin-resource-policy"] == "same-origin"
        assert "access-control-allow-origin" not in answer.headers
