"""A mesh beyond what the page shows, sent or made by a job: thinned by the server, told with the faces it has."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Request, expect

from store.settings import Settings
from tests.acceptance.service import binary_stl
from tests.api.live import serving
from tests.solids import sphere
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit

PATIENCE_MS = 200_000  # to read, thin and send half a million faces


@pytest.mark.slow
def test_a_large_upload_is_shown_by_a_coarser_mesh_of_the_server(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    mesh = sphere(200.0, 8)
    assert len(mesh.faces) > 500_000
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-large", port=0)
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        sent = live.client.post("/v1/meshes", files={"file": ("ball.stl", binary_stl(mesh))}, timeout=300)
        assert sent.status_code == 201, sent.text
        asked: list[str] = []
        seen.page.on("request", lambda request: _note(request, asked))
        seen.page.goto("/")
        expect(seen.page.get_by_text(re.compile(rf"^{len(mesh.faces):,} faces are shown by [1-4]\d\d,\d\d\d"))).to_be_visible(
            timeout=PATIENCE_MS
        )
        seen.picture("large")
        job = live.successful({"skin": (binary_stl(mesh), "model/stl", "skin.stl")})
        seen.page.goto(f"/#/jobs/{job.id}")
        expect(seen.page.get_by_text(re.compile(rf"^{len(mesh.faces):,} faces are shown by [1-4]\d\d,\d\d\d"))).to_be_visible(
            timeout=PATIENCE_MS
        )
    assert any(f"{job.id}/results/skin?most_faces=500000" in url for url in asked)
    assert any("most_faces=500000" in url for url in asked)


def _note(request: Request, asked: list[str]) -> None:
    asked.append(request.url)
