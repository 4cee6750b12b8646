"""Ears before they are used: shown where the server finds them, then pulled at in the view."""

from __future__ import annotations

import math
import re
from pathlib import Path

from playwright.sync_api import expect

from store.settings import Settings
from subjects.body import body
from tests.acceptance.service import binary_stl
from tests.api.live import serving
from tests.solids import sphere
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit

OTHER = sphere(100.0, 2)
FIELD_OF_VIEW_DEG = 32  # of the viewer's camera
NEAR = 0.25  # how far it stands from a place it was sent to, in radii of the body


def test_ears_are_shown_and_their_boxes_dragged(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    mesh = body(0)
    radius_mm = math.dist(mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)) / 2
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-ears", port=0)
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        other, href = (live.mesh_href(binary_stl(one)).removeprefix(live.url) for one in (OTHER, mesh))
        page = seen.page
        page.goto(f"/#/new?mesh={href.rpartition('/')[2]}")
        seen.drawn()
        page.get_by_role("button", name=re.compile("Thesis: VHP-Female")).click()
        page.get_by_role("button", name="Show where they are").click()
        expect(page.get_by_text("Found: left_ear, right_ear.")).to_be_visible()
        seen.drawn()
        seen.picture("ears-found")
        page.get_by_label("Skin", exact=True).select_option(other)
        expect(page.get_by_text("Found: ")).to_have_count(0)  # those were another body's
        page.get_by_label("Skin", exact=True).select_option(href)
        page.get_by_role("button", name="Show where they are").click()
        expect(page.get_by_text("Found: left_ear, right_ear.")).to_be_visible()
        page.get_by_label("My own boxes").check()
        page.get_by_role("button", name="Look at left_ear").click()
        low, high = (page.get_by_label(f"left_ear: {end} y in mm", exact=True) for end in ("min", "max"))
        top_mm, half_mm = float(high.input_value()), (float(high.input_value()) - float(low.input_value())) / 2
        page.evaluate("scrollTo(0, 0)")
        seen.drawn()
        view = page.locator(".viewer canvas").bounding_box()
        assert view is not None
        pixels_per_mm = view["height"] / (2 * NEAR * radius_mm * math.tan(math.radians(FIELD_OF_VIEW_DEG / 2)))
        x, y = view["x"] + view["width"] / 2, view["y"] + view["height"] / 2 - half_mm * pixels_per_mm
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x, y - 10 * pixels_per_mm, steps=5)
        page.mouse.up()
        expect(high).not_to_have_value(f"{top_mm:g}")
        assert abs(float(high.input_value()) - (top_mm + 10)) < 1.5, "pulled up by a centimetre"
        assert low.input_value() == f"{top_mm - 2 * half_mm:g}"
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
