"""A mesh or a field beyond what the page shows: thinned by the server, told with the faces it has."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Request, Response, expect

from core.fields.mapped import MappedField
from core.package.field_files import write_msh
from core.package.tissue import FREE_SPACE, Tissue
from store.settings import Settings
from tests.acceptance.service import binary_stl
from tests.api.live import serving
from tests.solids import sphere
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit

REPORT = {
    "process": "fields",
    "verdict": "simulation_ready",
    "summary": "skin: at most 3 V/m",
    **{name: {} for name in ("meshes", "thickness", "parameters", "software")},
    **{name: [] for name in ("pairs", "findings")},
    "methods": "",
}
MOST_BYTES = 30_000_000  # of a field however large: 52 for a face shown and its half a vertex, in gmsh's words
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


@pytest.mark.slow
def test_a_large_field_is_shown_by_a_coarser_surface_and_read_as_such(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    """Its magnitude grows from 1 V/m at the lowest place to 3 at the highest, so the middle of a view from above reads 3."""
    mesh = sphere(100.0, 8)
    heights = mesh.triangles().mean(axis=1)[:, 2]
    values = MappedField(2.0 + heights[:, None] / 100.0, np.zeros(len(heights)), "nearest")
    write_msh(tmp_path / "fields.msh", [Tissue("skin", mesh, None, 1.0, FREE_SPACE)], {"skin": values})
    content = (tmp_path / "fields.msh").read_bytes()
    report = {**REPORT, "fields": {"skin": {"faces": len(heights)}}}
    outputs = {
        "msh": (content, "application/x-gmsh", "fields.msh"),
        "report": (json.dumps(report).encode(), "application/json", "report.json"),
    }
    settings = Settings(data_dir=tmp_path / "data", broker_url=shared_valkey.url, queue="tests-field-large", port=0)
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        job = live.successful(outputs, process="fields")
        sizes: list[int] = []
        seen.page.on("response", lambda reply: _note_size(reply, sizes))
        seen.page.goto(f"/#/jobs/{job.id}")
        expect(seen.page.get_by_text(re.compile(rf"^{len(heights):,} faces are shown by [1-4]\d\d,\d\d\d"))).to_be_visible(
            timeout=PATIENCE_MS
        )
        expect(seen.page.get_by_text("Shown by fewer triangles, each with the value of one that lies there")).to_be_visible()
        seen.page.get_by_role("button", name="+z", exact=True).click()
        seen.page.locator(".viewer canvas").press("Enter")
        expect(seen.page.locator(".readout")).to_contain_text("of the coarser surface shown")
        expect(seen.page.locator(".readout")).to_contain_text(re.compile(r"Magnitude of the field (2\.9\d|3\.00) V/m"))
        seen.picture("large-field")
    assert len(sizes) == 1
    assert sizes[0] < MOST_BYTES < len(content)


def _note(request: Request, asked: list[str]) -> None:
    asked.append(request.url)


def _note_size(reply: Response, sizes: list[int]) -> None:
    if "/results/msh" in reply.url:
        sizes.append(int(reply.headers["content-length"]))
