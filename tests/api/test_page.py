"""The web page as it is served: what it may do, how it is cached, and what a server without it says."""

from __future__ import annotations

import asyncio
import gzip
import re
import tomllib
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI

from api.page_files import FOLDER, read_page
from api.problem_handlers import install_problem_handlers
from api.request_context import RequestContext
from api.routes.page import page_router
from tests.api.live import Live, problem_of
from tests.project.sources import ROOT

REFERENCES = re.compile(r'(?:src|href)="([^"]*)"')


def assets() -> list[str]:
    found = [path for path in read_page() if path != "/"]
    assert found, "the page was not built: `make web`"
    return found


def test_the_page_is_sent_to_whoever_opens_the_server(api: Live) -> None:
    answer = api.client.get("/")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    assert answer.headers["cache-control"] == "no-cache"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert api.client.get("/v1").json()["title"] == "Integument", "the landing document stays where it is"


def test_the_page_may_run_its_own_scripts_and_nothing_else(api: Live) -> None:
    policy = dict(part.strip().split(" ", 1) for part in api.client.get("/").headers["content-security-policy"].split(";"))
    assert policy["default-src"] == policy["frame-ancestors"] == policy["base-uri"] == "'none'"
    assert policy["script-src"] == policy["style-src"] == policy["connect-src"] == policy["worker-src"] == "'self'"
    assert "unsafe" not in str(policy)
    html = api.client.get("/").text
    assert "<style" not in html
    assert "style=" not in html
    assert re.findall(r"<script(?![^>]* src=)", html) == []


def test_everything_the_page_names_is_here(api: Live) -> None:
    named = REFERENCES.findall(api.client.get("/").text)
    assert named
    for path in named:
        assert path.startswith("/assets/")
        assert api.client.get(path).status_code == 200


def test_assets_are_kept_for_ever_and_the_page_is_asked_for_again(api: Live) -> None:
    for path in assets():
        answer = api.client.get(path)
        assert "immutable" in answer.headers["cache-control"]
        assert re.search(r"-[A-Za-z0-9_-]{8}\.[a-z0-9]+$", path), "the name changes with the content"
    etag = api.client.get("/").headers["etag"]
    again = api.client.get("/", headers={"If-None-Match": etag})
    assert (again.status_code, again.content) == (304, b"")


def test_text_is_packed_for_those_who_can_unpack(api: Live) -> None:
    path = next(path for path in assets() if path.endswith(".js"))
    with api.client.stream("GET", path, headers={"Accept-Encoding": "gzip"}) as packed:
        sent = b"".join(packed.iter_raw())
        assert packed.headers["content-encoding"] == "gzip"
    plain = api.client.get(path, headers={"Accept-Encoding": "identity"})
    assert "content-encoding" not in plain.headers
    assert gzip.decompress(sent) == plain.content
    head = api.client.head(path, headers={"Accept-Encoding": "identity"})
    assert (head.content, head.headers["content-length"]) == (b"", str(len(plain.content)))


def test_scripts_of_our_own_stay_small() -> None:
    """Budget of the page: 350 kB of packed JavaScript, the 3D library apart."""
    own = {
        path: len(file.packed or file.content)
        for path, file in read_page().items()
        if path.endswith(".js") and "three" not in path
    }
    assert 0 < sum(own.values()) <= 350_000, own


@pytest.mark.parametrize("path", ["/assets/", "/assets/../app.py", "/assets/%2e%2e/app.py", "/index.html", "/static/index.html"])
def test_nothing_else_of_the_disk_is_served(api: Live, path: str) -> None:
    problem_of(httpx.get(api.url + path), 404, "route.not_found")


def test_a_server_without_the_page_says_how_to_build_it(tmp_path: Path) -> None:
    app = FastAPI()
    install_problem_handlers(app)
    app.include_router(page_router(read_page(tmp_path)))
    app.add_middleware(RequestContext, allowed_hosts=("127.0.0.1",))
    transport = httpx.ASGITransport(app)

    async def ask() -> httpx.Response:
        async with httpx.AsyncClient(transport=transport, base_url="http://127.0.0.1") as client:
            return await client.get("/")

    answer = asyncio.run(ask())
    assert answer.status_code == 503
    assert answer.json()["code"] == "page.not_built"
    assert "make web" in answer.json()["detail"]


def test_the_page_is_part_of_the_wheel() -> None:
    """Built files are not in the repository; the build back-end leaves those out unless told."""
    with (ROOT / "pyproject.toml").open("rb") as file:
        assert str(FOLDER.relative_to(ROOT)) in tomllib.load(file)["tool"]["hatch"]["build"]["targets"]["wheel"]["artifacts"]
