"""The whole way through the page on the real body: upload, settings, job, cut view, colours, report, package."""

from __future__ import annotations

import io
import re
import zipfile
from pathlib import Path

import pytest
from playwright.sync_api import expect

from subjects.body import body
from tests.acceptance.service import binary_stl, read_stl
from tests.embedded import embedded
from tests.web.browser import COUNT_CALLS, chromium, visit, write

JOB_MS = 240_000


@pytest.mark.timeout(420)
def test_from_a_dropped_file_to_the_package(tmp_path: Path) -> None:
    mesh = body(0)
    metres = write(tmp_path / "lab member.stl", binary_stl(mesh))
    with embedded(tmp_path / "data") as server, chromium() as browser, visit(browser, server.url) as seen:
        page = seen.page
        page.goto("/")
        expect(page.get_by_role("heading", name="Drop the surface of a body here")).to_be_visible()
        seen.picture("1-empty")

        # upload: the browser shows the body and knows the unit before the server has the file
        page.get_by_label("Files to upload").set_input_files(metres)
        seen.drawn()
        expect(page.get_by_label("Unit of the coordinates in the file")).to_have_value("mm")
        expect(page.get_by_text("Received.")).to_be_visible()
        seen.picture("2-upload")
        page.get_by_role("button", name="Use this mesh").click()
        expect(page.get_by_text(f"{len(mesh.faces):,} faces")).to_be_visible()
        expect(page.get_by_text("✓ ready")).to_be_visible(timeout=JOB_MS)
        seen.drawn()
        seen.picture("3-checked")
        assert seen.barriers() == []

        # set up: a preset, one depth changed, and a box in the view
        page.get_by_role("link", name="Set up a job").click()
        page.get_by_role("button", name=re.compile("Skin, fat and average body")).click()
        page.get_by_label("Depth of layer 1 in mm").fill("1.5")
        page.get_by_role("button", name="Add a box").click()
        seen.drawn()
        seen.picture("4-settings")
        assert seen.barriers() == []
        page.get_by_role("button", name="Remove region", exact=True).click()
        page.get_by_role("button", name="Start the job").click()

        # the job goes on while the API dies and comes back, and the page follows it again
        expect(page.get_by_role("progressbar", name="Progress of the job")).to_be_visible()
        seen.picture("5-running")
        api = server.part("api")
        api.kill()
        expect(page.get_by_text("The connection is lost.")).to_be_visible()
        server.part("api", other_than=api.pid)
        expect(page.get_by_text("✓ ready")).to_be_visible(timeout=JOB_MS)

        # look inside
        seen.drawn()
        page.get_by_role("button", name="Cut across z").click()
        seen.drawn()
        seen.picture("6-cut")
        # the cut follows the slider without new memory on the graphics card, and nothing is drawn at rest
        page.evaluate(COUNT_CALLS)
        page.get_by_label("Place of the cut on z in mm").focus()
        for _ in range(5):
            page.keyboard.press("ArrowRight")
        seen.drawn()
        assert page.evaluate("[calls.draws > 0, calls.buffers]") == [True, 0]
        assert seen.comes_to_rest()
        page.get_by_label("Colours", exact=True).select_option("Distance to skin")
        page.get_by_label("Show skin").uncheck()
        expect(page.get_by_role("img", name=re.compile("^Distance to skin from"))).to_be_visible()
        view = page.locator(".viewer canvas").bounding_box()
        assert view is not None
        page.mouse.move(view["x"] + view["width"] / 2, view["y"] + view["height"] / 2)
        expect(page.locator(".readout")).to_contain_text("Distance to skin")
        seen.picture("7-thickness")
        page.get_by_role("button", name="Place 1", exact=False).first.click()
        seen.drawn()
        seen.picture("8-finding")
        page.get_by_label("Two surfaces side by side").check()
        expect(page.locator(".viewer canvas")).to_have_count(2)
        seen.drawn()
        page.get_by_role("button", name="Fit").last.scroll_into_view_if_needed()
        seen.picture("9-side-by-side")
        assert seen.barriers() == []

        # files
        with page.expect_download() as package:
            page.get_by_role("button", name="Package (zip)").click()
        with zipfile.ZipFile(io.BytesIO(package.value.path().read_bytes())) as archive:
            assert archive.testzip() is None
            assert len(read_stl(archive.read("stl/skin.stl")).faces) == len(mesh.faces)
        with page.expect_download() as report:
            page.get_by_role("button", name="Report (HTML)").click()
        assert b"average_body" in report.value.path().read_bytes()
        with page.expect_popup() as opened:
            page.get_by_role("link", name="Open the report").click()
        expect(opened.value.locator("body")).to_contain_text("average_body")
        opened.value.close()

        page.get_by_role("link", name="Jobs").click()
        jobs = page.get_by_role("checkbox", name=re.compile("^Compare job"))
        expect(jobs).to_have_count(2)
        for number in range(2):
            jobs.nth(number).check()
        seen.picture("10-jobs")
        assert seen.barriers() == []
        page.get_by_role("button", name="Compare two").click()
        expect(page.get_by_role("heading", name="Two jobs compared")).to_be_visible()
        expect(page.get_by_text("Layers › 1 › Depth (mm)")).to_be_visible()
        seen.picture("11-compared")

        # the same again, with what was set
        page.get_by_role("link", name="shells").click()
        page.get_by_role("link", name="Same settings again…").click()
        expect(page.get_by_label("Depth of layer 1 in mm")).to_have_value("1.5")
