"""What came of a job, as it is told: verdicts of what was made alone, every place of a finding, numbers as people write them."""

from __future__ import annotations

import json
from pathlib import Path

from playwright.sync_api import expect

from store.job import JobFailure
from store.settings import Settings
from tests.acceptance.service import binary_stl
from tests.api.live import serving
from tests.solids import sphere
from tests.valkey import ValkeyServer
from tests.web.browser import PHONE, chromium, visit

PLACES = [{"mesh": "skin", "point_mm": [0.0, 0.0, 10.0 * number], "faces": [number]} for number in range(8)]
REPORT = {
    "process": "validate",
    "verdict": "not_ready",
    "summary": "1 mesh is not ready",
    "meshes": {"skin": {"faces": 26_836, "area_mm2": 1_613_790.0, "volume_mm3": None, "quality": {"minimum": 0.018}}},
    "findings": [
        {"code": "mesh.not_closed", "severity": "error", "message": "open: see `heal`", "count": 26_836, "places": PLACES}
    ],
    "pairs": [],
    "methods": "",
    **{name: {} for name in ("thickness", "parameters", "software")},
}


def test_outcomes_are_told_in_full_and_in_order(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-outcome", port=0)
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        outputs = {
            "skin": (binary_stl(sphere(100.0, 2)), "model/stl", "skin.stl"),
            "report": (json.dumps(REPORT).encode(), "application/json", "report.json"),
        }
        job = live.successful(outputs)
        failed = live.failed(JobFailure("skin.not_closed", "input", "Mend it with `heal`", retryable=False), report=False)
        page = seen.page
        page.goto(f"/#/jobs/{job.id}")
        expect(page.locator(".heading .tag")).to_have_text(["done", "✓ ready"])
        findings = page.get_by_role("region", name="Findings")
        expect(findings.get_by_text("open: see heal")).to_be_visible()
        expect(findings.get_by_text("× 26,836")).to_be_visible()
        expect(findings.get_by_role("button", name="Show place")).to_have_count(6)
        findings.get_by_role("button", name="and 2 more").click()
        expect(findings.get_by_role("button", name="Show place")).to_have_count(8)
        expect(page.get_by_role("cell", name="16,137.9")).to_be_visible()
        expect(page.get_by_role("button", name="skin.stl")).to_be_visible()
        assert seen.barriers_everywhere() == []
        page.set_viewport_size(PHONE)  # type: ignore[arg-type]
        tops = [page.get_by_role("region", name=name).bounding_box() for name in ("View", "Findings", "Numbers")]
        assert all(tops)
        heights = [box["y"] for box in tops if box]
        assert heights == sorted(heights), "controls under the view they move, numbers last"
        page.goto(f"/#/jobs/{failed.id}")
        expect(page.get_by_text("Mend it with heal")).to_be_visible()
        expect(page.locator(".heading .tag")).to_have_text(["failed"])  # nothing was made to be judged
        page.goto("/#/jobs")
        page.get_by_label("Status").select_option(label="failed")
        expect(page.get_by_role("row")).to_have_count(2)
        page.get_by_label("Status").select_option(label="done")
        expect(page.get_by_text("1 mesh, no errors")).to_be_visible()
        assert seen.barriers_everywhere() == []
        seen.picture("outcome-jobs")
