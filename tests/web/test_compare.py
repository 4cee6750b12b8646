"""Two jobs, chosen in one go and compared line by line."""

from __future__ import annotations

import re
from pathlib import Path

from playwright.sync_api import expect

from store.settings import Settings
from tests.api.live import serving
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit


def test_two_jobs_are_compared(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-compare", port=0)
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        live.accepted()
        live.successful()
        seen.page.goto("/#/jobs")
        boxes = seen.page.get_by_role("checkbox", name=re.compile("^Compare job"))
        expect(boxes).to_have_count(2)
        # faster than anything is drawn anew between the two
        seen.page.evaluate("document.querySelectorAll('td input[type=checkbox]').forEach(box => box.click())")
        seen.page.get_by_role("button", name="Compare two").click()
        expect(seen.page.get_by_role("heading", name="Two jobs compared")).to_be_visible()
        expect(seen.page.locator("tr.differs").filter(has_text="Summary")).to_contain_text("1 mesh, no errors")
        assert seen.barriers() == []
