"""The form of `prepare`: steps that may be left out, ears that may be none, inner tissues by name."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, expect

from core.errors import InputError
from store.job import JobFailure
from store.settings import Settings
from tests.acceptance.service import binary_stl
from tests.api.live import serving
from tests.solids import sphere
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit

FIELD_OF_VIEW_DEG, SHOWN_SHARE = 32.0, 0.98  # of web/src/viewer/viewer.ts


def test_steps_and_tissues_are_sent_as_chosen_and_come_back(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-prepare", port=0)
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        skin = live.mesh_href(binary_stl(sphere(50.0, 2)))
        organ = live.mesh_href(binary_stl(sphere(10.0, 1)))
        page = seen.page
        page.goto(f"/#/new?mesh={skin.rpartition('/')[2]}")
        page.get_by_role("button", name=re.compile("Thesis: the whole way")).click()
        expect(page.get_by_label("Found by the server (auto)")).to_be_checked()
        page.get_by_label("None", exact=True).check()
        using = page.get_by_role("checkbox", name="Use it")
        expect(using.nth(0)).to_be_checked()  # heal
        expect(using.nth(1)).not_to_be_checked()  # decimate
        using.nth(0).uncheck()
        using.nth(4).uncheck()  # canals go with ears; detach and smooth are off
        using.nth(2).check()
        page.get_by_role("button", name="Add a box").first.click()
        pull_top(seen.page, seen.drawn, by_mm=20.0)
        page.get_by_role("button", name="Add a tissue").click()
        page.get_by_label("Mesh of tissue 1").select_option(organ)
        page.get_by_label("Name of tissue 1").fill("heart")
        page.get_by_label("Conductivity of heart in S/m").fill("0.4")
        page.get_by_label("Radius edge").fill("1.5")
        seen.picture("prepare-form")
        assert seen.barriers() == []
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
        job = page.url.rpartition("/")[2]
        asked = live.client.get(f"/v1/jobs/{job}/inputs").json()["inputs"]
        assert asked["heal"] is None
        [arm] = asked["detach"]["regions"]
        assert arm["box_mm"]["min"] == [-10, -10, -10]
        assert arm["box_mm"]["max"][:2] == [10, 10]
        assert abs(arm["box_mm"]["max"][2] - 30) < 2, "pulled up by two centimetres"
        assert "ears" not in asked
        assert "generate_canals" not in asked
        assert asked["tissues"] == [{"name": "heart", "mesh": {"href": organ}, "conductivity_s_per_m": 0.4}]
        assert asked["tetrahedra"]["radius_edge"] == 1.5
        page.goto(f"/#/new?like={job}")
        expect(page.get_by_label("Name of tissue 1")).to_have_value("heart")
        expect(using.nth(0)).not_to_be_checked()


def test_what_a_failed_job_left_is_shown_and_can_be_fetched(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-left", port=0)
    left = {
        "skin": (binary_stl(sphere(50.0, 2)), "model/stl", "skin.stl"),
        "fat": (binary_stl(sphere(49.0, 2)), "model/stl", "fat.stl"),
        "steps": (b"{}", "application/json", "steps.json"),
    }
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        failure = JobFailure.of(InputError("tissues.cross", "1 pair of tissues crosses", pairs=1))
        job = live.failed(failure, report=False, left=left)
        page = seen.page
        page.goto(f"/#/jobs/{job.id}")
        expect(page.get_by_text("1 pair of tissues crosses").first).to_be_visible()
        files = page.get_by_role("region", name="Downloads")
        with page.expect_download() as fetched:
            files.get_by_role("button", name="fat.stl").click()
        assert fetched.value.path().read_bytes() == left["fat"][0]
        expect(files.get_by_role("button", name="steps.json")).to_be_visible()
        expect(page.get_by_role("region", name="View").get_by_text("skin", exact=True)).to_be_visible()
        seen.drawn()
        seen.picture("job-left")
        assert seen.barriers() == []
        files.get_by_role("link", name="New job with skin").click()
        expect(page.get_by_role("button", name="Start the job")).to_be_enabled()


def pull_top(page: Page, drawn: Callable[[], None], *, by_mm: float) -> None:
    """Take the handle on top of a box of 20 mm in the middle of a sphere of 50 mm, seen along x, and pull it up."""
    page.evaluate("scrollTo(0, 0)")
    page.get_by_role("button", name="+x").click()
    drawn()
    view = page.locator(".viewer canvas").bounding_box()
    assert view is not None
    half = math.radians(FIELD_OF_VIEW_DEG / 2)
    away_mm = SHOWN_SHARE * 50.0 * math.sqrt(3) / math.sin(half)
    pixels_per_mm = view["height"] / (2 * away_mm * math.tan(half))
    x, y = view["x"] + view["width"] / 2, view["y"] + view["height"] / 2 - 10.0 * pixels_per_mm
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - by_mm * pixels_per_mm, steps=5)
    page.mouse.up()
