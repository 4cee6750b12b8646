"""The report as a file, opened from disk in Chromium without any network."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from core.reports.figures import draw_mesh_figures
from core.reports.html import render_html
from core.reports.scene.scene import make_scene
from core.schema.report import Report
from core.validation.validate import validate
from subjects.body import body
from tests.solids import flipped
from tests.web.browser import DESK, PATIENCE_MS, PHONE, Visit, chromium

HOSTILE = "<img src=x onerror=alert(1)>"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as opened:
        yield opened


@pytest.fixture(scope="module")
def report_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    skin = flipped(body(0), [100])
    surfaces = {"skin": skin, HOSTILE: skin.with_vertices(skin.vertices * 0.97 + (0.0, 0.0, 20.0))}
    depths = np.linalg.norm(surfaces[HOSTILE].vertices - skin.vertices, axis=1)
    found = validate(surfaces)
    report = Report(
        process="validate",
        verdict=found.verdict,
        summary="Two surfaces.",
        meshes=found.meshes,
        pairs=found.pairs,
        nesting=found.nesting,
        findings=found.findings,
    )
    path = tmp_path_factory.mktemp("mailed") / "report.html"
    path.write_text(
        render_html(report, draw_mesh_figures(surfaces, findings=found.findings), make_scene(surfaces, {HOSTILE: depths})),
        encoding="utf-8",
    )
    return path


@contextmanager
def opened(browser: Browser, path: Path, size: dict[str, int], *, dark: bool = False) -> Iterator[Visit]:
    """From disk, without network; at the end nothing may have been asked of anybody, nothing have failed."""
    context = browser.new_context(viewport=size, color_scheme="dark" if dark else "light", offline=True)  # type: ignore[arg-type]
    context.set_default_timeout(PATIENCE_MS)
    seen = Visit(context.new_page())
    seen.page.on("console", lambda message: seen.wrong.append(message.text) if message.type in ("error", "warning") else None)
    seen.page.on("pageerror", lambda error: seen.wrong.append(str(error)))
    seen.page.on("dialog", lambda dialog: seen.wrong.append(dialog.message))
    seen.page.on("request", lambda asked: None if asked.url == path.as_uri() else seen.wrong.append(asked.url[:200]))
    seen.page.goto(path.as_uri())
    try:
        yield seen
    finally:
        context.close()
    assert [text for text in seen.wrong if "GPU stall" not in text] == []  # said by the software renderer


def digest(page: Page) -> str:
    return hashlib.sha256(page.locator(".viewer canvas").screenshot()).hexdigest()


def into_sight(seen: Visit) -> Page:
    seen.page.locator("#scene-stage").scroll_into_view_if_needed()
    seen.drawn()
    return seen.page


def test_the_surfaces_turn_are_cut_and_hidden(browser: Browser, report_file: Path) -> None:
    assert report_file.stat().st_size < 8_000_000
    with opened(browser, report_file, DESK) as seen:
        page = into_sight(seen)
        seen.picture("report-3d")
        pictures = [digest(page)]
        page.get_by_role("button", name="+x", exact=True).click()
        page.wait_for_timeout(500)
        pictures.append(digest(page))
        page.get_by_role("button", name="Cut across x").click()
        page.wait_for_timeout(500)
        pictures.append(digest(page))
        seen.picture("report-cut")
        page.get_by_label("Show skin", exact=True).uncheck()
        page.wait_for_timeout(500)
        pictures.append(digest(page))
        page.get_by_label("Depth: distance to the skin, in colours").check()
        page.wait_for_timeout(500)
        pictures.append(digest(page))
        assert page.get_by_label("Highest value of the colours").count() == 1
        seen.picture("report-depth")
        assert len(set(pictures)) == len(pictures)
        assert seen.barriers() == []


def test_a_place_of_a_finding_is_shown(browser: Browser, report_file: Path) -> None:
    with opened(browser, report_file, DESK) as seen:
        page = into_sight(seen)
        before = digest(page)
        page.locator("#findings .show-place:visible").first.click()
        page.wait_for_timeout(500)
        assert digest(page) != before
        assert page.locator(".viewer canvas").evaluate("canvas => canvas === document.activeElement")
        seen.picture("report-place")


def test_it_fits_a_phone_in_the_dark(browser: Browser, report_file: Path) -> None:
    with opened(browser, report_file, PHONE, dark=True) as seen:
        page = into_sight(seen)
        assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
        seen.picture("report-phone-dark")
        assert seen.barriers() == []


def test_a_changed_script_does_not_run(browser: Browser, report_file: Path, tmp_path: Path) -> None:
    text = report_file.read_text(encoding="utf-8")
    head, tail = text.rsplit("<script>", 1)
    changed = tmp_path / "changed.html"
    changed.write_text(f"{head}<script>document.title='taken over';{tail}", encoding="utf-8")
    page = browser.new_page()
    page.goto(changed.as_uri())
    assert page.title() != "taken over"
    page.locator("#scene-stage").scroll_into_view_if_needed()
    assert "Everything below needs neither" in page.locator("#scene-stage").inner_text()
    page.close()


def test_without_a_script_everything_else_is_there(browser: Browser, report_file: Path) -> None:
    context = browser.new_context(java_script_enabled=False, offline=True)
    page = context.new_page()
    page.goto(report_file.as_uri())
    assert page.get_by_role("heading", name="Not ready").is_visible()
    assert page.locator("figure img").count() >= 3
    assert "needs JavaScript and WebGL 2" in page.locator("#scene-stage").inner_text()
    context.close()


def test_paper_shows_the_surfaces_on_white_and_no_controls(browser: Browser, report_file: Path) -> None:
    with opened(browser, report_file, DESK, dark=True) as seen:
        page = into_sight(seen)
        page.evaluate("dispatchEvent(new Event('beforeprint'))")
        page.emulate_media(media="print")
        paper = page.locator("canvas.printed.drawn")
        assert paper.is_visible()
        assert not page.locator(".viewer").is_visible()
        corner, inked = paper.evaluate(
            """canvas => {
              const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
              let inked = 0;
              for (let at = 0; at < pixels.length; at += 4) inked += pixels[at] < 200;
              return [[...pixels.slice(0, 4)], inked];
            }"""
        )
    assert corner == [255, 255, 255, 255]
    assert inked > 1000
