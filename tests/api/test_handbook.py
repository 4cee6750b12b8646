"""The documentation as the server shows it: only files that were built, with scripts named by checksum."""

from __future__ import annotations

import asyncio
import base64
import hashlib
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from api.handbook_files import find_handbook
from api.problem_handlers import install_problem_handlers
from api.request_context import RequestContext
from api.routes.page import handbook_router

SCRIPT = "document.body.dataset.theme = 'dark';"
FILES = {
    "index.html": f"<h1>Integument</h1><script>{SCRIPT}</script><script src='_static/a.js'></script>",
    "docs/quickstart.html": "<h1>Quickstart</h1>",
    "_static/a.js": "let a = 1;",
    "_static/a.py": "not of the site",
}


def site(folder: Path) -> FastAPI:
    app = FastAPI()
    app.add_middleware(RequestContext, allowed_hosts=("here",))
    install_problem_handlers(app)
    app.include_router(handbook_router(find_handbook(folder)))
    return app


class Reader:
    """Asks an application, following what it refers to."""

    def __init__(self, folder: Path) -> None:
        self._app = site(folder)

    def get(self, path: str, **headers: str) -> httpx.Response:
        async def ask() -> httpx.Response:
            transport = httpx.ASGITransport(self._app)
            async with httpx.AsyncClient(transport=transport, base_url="http://here", follow_redirects=True) as client:
                return await client.get(path, headers=headers)

        return asyncio.run(ask())


@pytest.fixture
def handbook(tmp_path: Path) -> Reader:
    for name, text in FILES.items():
        (tmp_path / "site" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "site" / name).write_text(text)
    (tmp_path / "secret.txt").write_text("secret")
    return Reader(tmp_path / "site")


def test_its_first_page_is_its_index(handbook: Reader) -> None:
    assert handbook.get("/handbook").url.path == "/handbook/"
    first = handbook.get("/handbook/")
    assert (first.status_code, first.text) == (200, FILES["index.html"])
    assert handbook.get("/handbook/docs/quickstart.html").text == FILES["docs/quickstart.html"]
    assert handbook.get("/handbook/_static/a.js").headers["content-type"].startswith("text/javascript")
    assert handbook.get("/handbook/", **{"If-None-Match": first.headers["etag"]}).status_code == 304


def test_a_page_runs_the_scripts_it_came_with_and_asks_nobody_else(handbook: Reader) -> None:
    policy = dict(part.strip().split(" ", 1) for part in handbook.get("/handbook/").headers["content-security-policy"].split(";"))
    checksum = base64.b64encode(hashlib.sha256(SCRIPT.encode()).digest()).decode()
    assert policy["script-src"] == f"'self' 'sha256-{checksum}'"
    assert policy["default-src"] == policy["frame-ancestors"] == policy["base-uri"] == "'none'"
    assert policy["connect-src"] == "'self'"


@pytest.mark.parametrize(
    "path", ["_static/a.py", "nowhere.html", "../secret.txt", "%2e%2e/secret.txt", "docs", "docs/../../secret.txt"]
)
def test_what_is_no_page_is_not_found(handbook: Reader, path: str) -> None:
    answer = handbook.get(f"/handbook/{path}")
    assert answer.status_code == 404
    assert "secret" not in answer.text.replace(path, "").replace("secret.txt", "")


def test_a_server_without_it_says_how_to_build_it(tmp_path: Path) -> None:
    answer = Reader(tmp_path).get("/handbook/")
    assert (answer.status_code, answer.json()["code"]) == (503, "handbook.not_built")
    assert "make docs" in answer.json()["detail"]
