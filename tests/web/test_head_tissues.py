"""*Head, 7 tissues you have* from the page to its end: FreeSurfer's average head with skull, brain and cortex."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from core.mesh import Mesh
from core.schema.shells import Layer, ShellsInputs
from core.shells.nested_shells import create_shells
from subjects.fsaverage import fsaverage
from subjects.head_tissues import NOWHERE, head_tissue
from tests.acceptance.service import binary_stl
from tests.embedded import embedded
from tests.web.browser import chromium, visit, write

HOUR_MS = 3_600_000
SKULL_MM = 6.5  # crosses the inner skull, which is 6.1 mm below the skin at its highest


def given() -> dict[str, Mesh]:
    """What a lab has: surfaces of one head that touch and cross each other, the left hemisphere for grey and white matter."""
    skin = fsaverage("head")
    layers = (Layer(name="skull", depth_mm=SKULL_MM),)
    [skull] = create_shells(skin, ShellsInputs(skin=NOWHERE, layers=layers))
    return {
        "skin": skin,
        "skull": skull.mesh,
        "csf": head_tissue("inner_skull"),
        "gm": head_tissue("grey_left"),
        "wm": head_tissue("white_left"),
    }


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_the_tissues_of_a_real_head_become_a_model(tmp_path: Path) -> None:
    surfaces = given()
    with embedded(tmp_path / "data") as server, chromium() as browser, visit(browser, server.url) as seen:
        page = seen.page
        page.goto("/")
        expect(page.get_by_role("heading", name="Drop the surface of a body here")).to_be_visible()
        for name, mesh in surfaces.items():
            page.get_by_label("Files to upload").set_input_files(write(tmp_path / f"{name}.stl", binary_stl(mesh)))
            item = page.get_by_role("article", name=f"Upload of {name}.stl")
            item.get_by_label("Unit of the coordinates in the file").select_option("mm")
            item.get_by_role("button", name="Use this mesh").click()
            expect(page.get_by_text(f"{len(mesh.faces):,} faces").first).to_be_visible()
            expect(item).to_have_count(0)
        page.goto("/#/new")
        page.get_by_role("button", name=re.compile("Head, 7 tissues you have")).click()
        choose(page, "Skin", "skin")
        for number, name in enumerate(["skull", "csf", "gm", "wm"], start=1):
            expect(page.get_by_label(f"Name of tissue {number}")).to_have_value(name)
            choose(page, f"Mesh of tissue {number}", name)
        seen.drawn()
        seen.picture("head-tissues-form")
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("✓ ready")).to_be_visible(timeout=HOUR_MS)
        expect(page.get_by_label("Show average_body")).to_be_visible()
        for name in surfaces:
            expect(page.get_by_label(f"Show {name}", exact=True)).to_be_visible()
        page.get_by_role("button", name="Cut across x").click()
        page.get_by_label("x of the cut in mm").fill("-30")
        page.get_by_role("button", name="+x", exact=True).click()
        seen.drawn()
        seen.picture("head-tissues-cut")
        assert seen.barriers() == []


def choose(page: Page, label: str, name: str) -> None:
    """The mesh of this name, among those the server holds."""
    choice = page.get_by_label(label, exact=True)
    choice.select_option(label=choice.locator("option").filter(has_text=re.compile(f"^{name} ")).inner_text())
