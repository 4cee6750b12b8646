"""The form of `separate`: surfaces by name, who may not move, who has priority, who holds whom, and what the job is called."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import expect

from store.settings import Settings
from tests.acceptance.service import binary_stl
from tests.api.live import serving
from tests.solids import sphere
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit


def test_who_moves_is_sent_as_typed(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-separate", port=0)
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        for name, size in (("grey", 50.0), ("white", 49.95)):
            reply = live.upload(binary_stl(sphere(size, 2)), f"{name}.stl", unit="mm")
            assert reply.status_code == 201, reply.text
        page = seen.page
        page.goto("/#/new?process=separate")
        for name in ("grey", "white"):
            page.get_by_label(f"{name} (128 faces)").check()
        page.get_by_label("Fixed: grey").check()
        page.get_by_label("Priority: grey").fill("1")
        page.get_by_label("Inside: white").select_option("grey")
        page.get_by_label("Inside: grey").select_option("nothing")
        page.get_by_label("Min gap (mm)").fill("0.2")
        page.get_by_label("Name", exact=True).fill("both sides")
        page.get_by_label("Labels, separated by commas").fill("pilot, cortex")
        seen.drawn()
        seen.picture("separate-form")
        assert seen.barriers() == []
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
        job = page.url.rpartition("/")[2]
        told = live.client.get(f"/v1/jobs/{job}").json()
        assert (told["name"], told["labels"]) == ("both sides", ["pilot", "cortex"])
        asked = live.client.get(f"/v1/jobs/{job}/inputs").json()["inputs"]
        assert set(asked["meshes"]) == {"grey", "white"}
        assert asked["fixed"] == ["grey"]
        assert asked["priority"] == {"grey": 1}
        assert asked["inside"] == {"white": "grey", "grey": None}
        assert asked["min_gap_mm"] == 0.2
