"""The cut through seven shells of a head: filled in one colour each, without stray pixels, and read under the pointer."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Page, expect

from core.schema.shells import Layer, ShellsInputs
from core.shells.nested_shells import create_shells
from store.settings import Settings
from subjects.fsaverage import fsaverage
from subjects.head_tissues import NOWHERE
from tests.acceptance.service import binary_stl
from tests.api.live import serving
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit

DEPTHS_MM = {"fat": 1.0, "average_body": 3.0, "skull": 6.0, "csf": 12.0, "gm": 15.0, "wm": 18.0}
INNERMOST = (62, 58, 110)  # of web/src/tissues.ts


def stray_pixels(picture: NDArray[np.int_]) -> int:
    """Pixels unlike the sixteen that stand around them in a square, all of one colour. Outlines are longer than that."""
    window = sliding_window_view(picture, (5, 5), axis=(0, 1))
    sides = [window[..., 0, :], window[..., 4, :], window[..., 1:4, 0], window[..., 1:4, 4]]
    around = np.concatenate(sides, axis=-1)
    even = np.ptp(around, axis=-1).max(axis=-1) <= 2
    unlike = np.abs(window[..., 2, 2] - around[..., 0]).max(axis=-1) > 6
    return int((even & unlike).sum())


def look(page: Page) -> NDArray[np.int_]:
    """The 3D view below its buttons."""
    shot = Image.open(io.BytesIO(page.locator(".viewer canvas").screenshot())).convert("RGB")
    return np.asarray(shot, dtype=np.int64)[40:]


def test_the_count_of_stray_pixels_counts_them() -> None:
    picture = np.full((40, 40, 3), 200, dtype=np.int64)
    assert stray_pixels(picture) == 0
    picture[20, 20], picture[10] = 50, 90  # one pixel, and a line
    assert stray_pixels(picture) == 1


@pytest.mark.slow
def test_sections_have_no_stray_pixels(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    skin = fsaverage("head")
    layers = tuple(Layer(name=name, depth_mm=depth) for name, depth in DEPTHS_MM.items())
    shells = {"skin": skin, **{one.name: one.mesh for one in create_shells(skin, ShellsInputs(skin=NOWHERE, layers=layers))}}
    outputs = {name: (binary_stl(mesh), "model/stl", f"{name}.stl") for name, mesh in shells.items()}
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-section", port=0)
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        job = live.successful(outputs)
        page = seen.page
        page.goto(f"/#/jobs/{job.id}")
        seen.drawn()
        strays = {}
        for axis in "xz":
            page.get_by_role("button", name=f"Cut across {axis}").click()
            page.get_by_role("button", name=f"+{axis}", exact=True).click()
            seen.drawn()
            picture = look(page)
            seen.picture(f"section-{axis}")
            strays[f"{axis} straight"] = stray_pixels(picture)
            assert (np.abs(picture - INNERMOST).max(axis=-1) <= 2).sum() > 0.05 * picture[..., 0].size, "the inside is filled"
            for _ in range(3):
                page.locator(".viewer canvas").press("ArrowRight")
                page.locator(".viewer canvas").press("ArrowUp")
            seen.drawn()
            strays[f"{axis} aslant"] = stray_pixels(look(page))
        assert strays == dict.fromkeys(strays, 0)
        page.locator(".viewer canvas").press("Home")
        page.get_by_role("button", name="+z", exact=True).click()
        page.locator(".viewer canvas").press("Enter")
        expect(page.locator(".readout")).to_contain_text("wm")
        expect(page.locator(".readout")).to_contain_text("in the section")
