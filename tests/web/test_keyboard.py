"""The whole way by Tab, Enter, Space and arrow keys alone: from a file to the package, the focus in sight at every step."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.acceptance.service import binary_stl
from tests.embedded import embedded
from tests.solids import sphere
from tests.web.browser import Visit, chromium, visit, write

JOB_MS = 120_000
MOST_STEPS = 90  # of Tab from one control to the next that is wanted
FOCUSED = """() => {
    const one = document.activeElement;
    const style = getComputedStyle(one);
    const box = one.getBoundingClientRect();
    return {
        name: one.getAttribute("aria-label") || one.labels?.[0]?.innerText || one.innerText || "",
        marked: (style.outlineStyle !== "none" && parseFloat(style.outlineWidth) > 0) || style.boxShadow !== "none",
        inSight: box.bottom > 0 && box.top < innerHeight && box.right > 0 && box.left < innerWidth,
        isBody: one === document.body,
    };
}"""


class Hands:
    """A person without a mouse."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.passed: list[str] = []

    def press(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)

    def focused(self) -> dict[str, Any]:
        """What has the focus; it must be seen where it is."""
        self.page.wait_for_timeout(30)
        told: dict[str, Any] = self.page.evaluate(FOCUSED)
        if not told["isBody"]:
            assert told["marked"], f"the focus on {told['name']!r} is not seen"
            assert told["inSight"], f"{told['name']!r} has the focus out of sight"
        return told

    def to(self, name: str, *, by: str = "Tab") -> None:
        """Tab until a control whose name begins like this has the focus."""
        for _ in range(MOST_STEPS):
            self.press(by)
            told = self.focused()
            self.passed.append(told["name"].split("\n")[0][:40])
            if re.match(name, told["name"].strip()):
                return
        raise AssertionError(f"no way to {name!r} by {by}; last {self.passed[-MOST_STEPS:]}")

    def choose(self, value: str) -> None:
        """In a list: down until the option is there."""
        self.press("Home")
        for _ in range(20):
            if self.page.evaluate("document.activeElement.value") == value:
                return
            self.press("ArrowDown")
        raise AssertionError(f"no option {value!r}")


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_the_whole_way_without_a_mouse(tmp_path: Path) -> None:
    path = write(tmp_path / "ball.stl", binary_stl(sphere(80.0, 2)))
    with embedded(tmp_path / "data") as server, chromium() as browser, visit(browser, server.url) as seen:
        page = seen.page
        hands = Hands(page)
        page.goto("/")
        expect(page.get_by_role("heading", name="Drop the surface of a body here")).to_be_visible()
        open_and_leave_dialog(hands)
        send(hands, path)
        assert seen.barriers_everywhere() == []
        set_up(hands, seen)
        hands.to("Start the job")
        hands.press("Enter")
        expect(page.get_by_text("✓ ready")).to_be_visible(timeout=JOB_MS)
        seen.drawn()
        look_around(hands)
        look_inside(hands)
        assert seen.barriers_everywhere() == []
        take_home(hands)


def open_and_leave_dialog(hands: Hands) -> None:
    """Escape closes it, and the focus is where it was."""
    hands.to("API key")
    hands.press("Enter")
    expect(hands.page.get_by_role("dialog")).to_be_visible()
    expect(hands.page.get_by_label("Key", exact=True)).to_be_focused()
    hands.press("Escape")
    expect(hands.page.get_by_role("dialog")).to_be_hidden()
    expect(hands.page.get_by_role("button", name="API key")).to_be_focused()


def send(hands: Hands, path: Path) -> None:
    """The first step of a page leads past its head."""
    hands.page.reload()
    hands.to("Skip to the content")
    hands.press("Enter")
    with hands.page.expect_file_chooser() as chooser:
        hands.to("Choose files")
        hands.press("Enter")
    chooser.value.set_files(path)
    expect(hands.page.get_by_text("Received.")).to_be_visible()
    hands.to("Unit of the coordinates")
    hands.choose("mm")
    hands.to("Use this mesh")
    hands.press("Enter")
    expect(hands.page.get_by_role("link", name="Set up a job")).to_be_visible()
    expect(hands.page.get_by_text("✓ ready")).to_be_visible(timeout=JOB_MS)


def set_up(hands: Hands, seen: Visit) -> None:
    page = hands.page
    hands.to("Set up a job")
    hands.press("Enter")
    expect(page.get_by_role("heading", name="New job")).to_be_visible()
    expect(page.get_by_label("Depth of layer 1 in mm")).to_be_visible()
    seen.drawn()
    hands.to("3D view")  # the view comes first, and lets go of the focus
    hands.to("Skin, fat and average body")
    hands.press("Enter")
    hands.to("Process")
    hands.to("Depth of layer 1 in mm")
    hands.press("Control+a")
    page.keyboard.type("1.5")
    hands.to("Side of layer 1")
    hands.to("Remove layer average_body")
    hands.to("Add a layer")
    hands.press("Enter")
    expect(page.get_by_label("Name of layer 3")).to_be_visible()
    hands.to("Remove layer layer", by="Shift+Tab")
    hands.press("Enter")
    expect(page.get_by_label("Name of layer 3")).to_have_count(0)
    hands.to("Add a box")
    hands.press("Enter")
    hands.to("region: min x in mm", by="Shift+Tab")
    hands.press("Control+a")
    page.keyboard.type("-30")
    expect(page.get_by_label("region: min x in mm")).to_have_value("-30")
    assert seen.barriers_everywhere() == []
    hands.to("Remove region", by="Shift+Tab")
    hands.press("Enter")
    expect(page.get_by_label("region: min x in mm")).to_have_count(0)


def look_around(hands: Hands) -> None:
    """Turned, moved, read in the middle and let go of."""
    page = hands.page
    hands.to("3D view of the result")
    hands.press("ArrowRight", "Shift+ArrowUp", "Shift+ArrowDown", "+", "-", "Enter")
    expect(page.locator(".readout")).to_contain_text("skin")
    before = page.locator(".readout").inner_text()
    hands.press("ArrowLeft", "ArrowLeft")
    expect(page.locator(".readout")).not_to_have_text(before)
    hands.press("Escape")
    expect(page.locator(".readout")).to_have_count(0)
    hands.press("Enter")
    hands.to("Fit")
    with page.expect_download() as picture:
        hands.to("Save picture")
        hands.press("Enter")
    assert picture.value.path().read_bytes().startswith(b"\x89PNG")


def look_inside(hands: Hands) -> None:
    page = hands.page
    hands.to("Show skin")
    hands.press("Space")
    expect(page.get_by_label("Show skin")).not_to_be_checked()
    hands.press("Space")
    hands.to("Opacity of skin")
    hands.press("ArrowLeft")
    expect(page.get_by_label("Opacity of skin")).to_have_value("0.95")
    hands.to("Colour of skin")
    hands.to("Cut across z")
    hands.press("Enter")
    hands.to("Place of the cut on z in mm")
    at = page.get_by_label("z of the cut in mm").input_value()
    hands.press("ArrowRight", "ArrowRight")
    expect(page.get_by_label("z of the cut in mm")).not_to_have_value(at)
    hands.to("Colours")
    hands.choose("Distance to skin")
    expect(page.get_by_role("img", name=re.compile("^Distance to skin from"))).to_be_visible()
    hands.to("Highest value of the colours")
    hands.press("Control+a")
    page.keyboard.type("2")
    hands.press("Enter")
    expect(page.get_by_role("img", name=re.compile("^Distance to skin from .* to 2.00 mm"))).to_be_visible()
    hands.to("Two surfaces side by side")
    hands.press("Space")
    expect(page.locator(".viewer canvas")).to_have_count(2)
    hands.press("Space")


def take_home(hands: Hands) -> None:
    with hands.page.expect_download() as package:
        hands.to("Package")
        hands.press("Enter")
    assert package.value.path().read_bytes().startswith(b"PK")
    hands.to("Report .HTML")
    places = hands.page.get_by_role("button", name=re.compile("^Show place 1 of"))
    if places.count() > 0:
        hands.to("Show place 1 of")
        hands.press("Enter")
    hands.to("Same settings again", by="Shift+Tab")
