"""Every class of answer carries the headers that keep a browser from doing anything with it; none names our software."""

from __future__ import annotations

from pathlib import Path

import httpx
import pytest

from api.request_context import SECURITY_HEADERS
from store.api_keys import ApiKeys
from store.scope import Scope
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, serving
from tests.core.io.stl_bytes import binary_stl
from tests.seaweed import SeaweedServer

MISSING = "/v1/jobs/00000000-0000-4000-8000-000000000000"
REQUESTS: dict[str, tuple[int, str, str, dict[str, str]]] = {  # name -> status, method, path, headers
    "document": (200, "GET", "/v1", {}),
    "probe": (200, "GET", "/healthz", {}),
    "metrics": (200, "GET", "/metrics", {}),
    "file": (200, "GET", "{mesh}/file", {}),
    "converted file": (200, "GET", "{mesh}/file?format=obj", {}),
    "head": (200, "HEAD", "{mesh}/file", {}),
    "part": (206, "GET", "{mesh}/file", {"Range": "bytes=0-9"}),
    "not modified": (304, "GET", "{mesh}/file", {"If-None-Match": "*"}),
    "no part": (416, "GET", "{mesh}/file", {"Range": "bytes=999999-"}),
    "report": (200, "GET", "{job}/report", {"Accept": "text/html"}),
    "stream": (200, "GET", "{job}/events", {}),
    "options": (204, "OPTIONS", "/v1/uploads", {"Tus-Resumable": "1.0.0"}),
    "created": (201, "POST", "/v1/uploads", {"Tus-Resumable": "1.0.0", "Upload-Length": "5"}),
    "wrong version": (412, "POST", "/v1/uploads", {"Upload-Length": "5"}),
    "bad query": (422, "GET", "/v1/jobs?limit=x", {}),
    "bad body": (415, "POST", "/v1/processes/validate/execution", {}),
    "not there": (404, "GET", MISSING, {}),
    "no route": (404, "GET", "/nowhere", {}),
    "no method": (405, "PUT", "/v1", {}),
    "foreign host": (400, "GET", "/v1", {"Host": "evil.example"}),
    "foreign page": (403, "POST", "/v1/uploads", {"Origin": "http://evil.example"}),
    "not ready": (503, "GET", "/readyz", {}),
}


def require_headers(answer: httpx.Response) -> None:
    for name, value in SECURITY_HEADERS.items():
        told = answer.headers[name]
        assert told == value or (name == "Content-Security-Policy" and told.startswith("default-src 'none'")), name
    assert answer.headers["x-request-id"]
    assert not {"access-control-allow-origin", "x-powered-by", "set-cookie"} & set(answer.headers)


@pytest.mark.parametrize("name", REQUESTS)
def test_whatever_is_answered_has_them(api: Live, mesh_href: str, name: str) -> None:
    status, method, path, headers = REQUESTS[name]
    target = path.format(mesh=mesh_href, job=f"/v1/jobs/{api.successful().id}" if "{job}" in path else "")
    answer = api.client.request(method, target, headers=headers)
    assert answer.status_code == status, answer.text
    require_headers(answer)


def test_also_who_is_sent_on_or_away(tmp_path: Path, seaweed: SeaweedServer) -> None:
    settings = Settings(
        data_dir=tmp_path,
        broker_url="redis://127.0.0.1:1/0",
        blobs_url=seaweed.new_bucket(),
        blobs_links_s=60,
    )
    with serving(settings) as live:
        path = live.mesh_href(binary_stl()) + "/file"
        sent_on = live.client.get(path)
        assert sent_on.status_code == 307
        require_headers(sent_on)
        assert sent_on.headers["cache-control"] == "no-store", "the link is a key to the file"
        key = ApiKeys(live.services.db).create(DEFAULT_WORKSPACE, "", [Scope.ADMIN])
        for headers, status in (({}, 401), ({"Authorization": f"Bearer {key.text}"}, 403)):
            refused = live.client.get(path, headers=headers)
            assert refused.status_code == status
            require_headers(refused)
