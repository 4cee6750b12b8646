"""Debian's Chromium, headless, and what every page in it is watched for."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, ConsoleMessage, Dialog, Page, Request, expect, sync_playwright

from tests.project.sources import ROOT

NAMES = ("chromium", "chromium-browser", "google-chrome")
# drawn by the processor: there is no graphics card; root has no sandbox of Chromium's own, the page is ours
OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]
PICTURES = ROOT / "out" / "web"
AXE = ROOT / "web" / "node_modules" / "axe-core" / "axe.min.js"
PATIENCE_MS = 30_000
# draw calls and buffers made anew, of all 3D views of a page
COUNT_CALLS = """
globalThis.calls = { draws: 0, buffers: 0 };
const kinds = { drawElements: "draws", drawArrays: "draws", bufferData: "buffers" };
for (const [name, kind] of Object.entries(kinds)) {
  const real = WebGL2RenderingContext.prototype[name];
  WebGL2RenderingContext.prototype[name] = function (...given) {
    calls[kind] += 1;
    return real.apply(this, given);
  };
}
undefined; // a function as the last value would be called
"""
# a refusal is shown by the page; headers are ignored where there is no TLS
EXPECTED = ("Failed to load resource", "Cross-Origin-Opener-Policy header has been ignored")
DESK, PHONE = {"width": 1280, "height": 860}, {"width": 390, "height": 844}


@contextmanager
def chromium(names: Mapping[str, str] | None = None) -> Iterator[Browser]:
    """`names`: hosts it is to find at these addresses. Raises RuntimeError with the command that installs it."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        raise RuntimeError("The browser tests need Chromium: apt-get install -y chromium (or: make debian)")
    expect.set_options(timeout=PATIENCE_MS)
    with sync_playwright() as playwright:
        rules = ",".join(f"MAP {name} {address}" for name, address in (names or {}).items())
        browser = playwright.chromium.launch(executable_path=found, args=[*OPTIONS, f"--host-resolver-rules={rules}"])
        try:
            yield browser
        finally:
            browser.close()


@dataclass
class Visit:
    """A page of our server, and all that went wrong on it."""

    page: Page
    wrong: list[str] = field(default_factory=list)

    def picture(self, name: str) -> None:
        """Kept in out/web/ for people."""
        PICTURES.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=PICTURES / f"{name}.png")

    def drawn(self) -> None:
        """Returns when the 3D view shows something."""
        self.page.wait_for_selector('.viewer[data-ready="true"]', timeout=PATIENCE_MS)
        self.page.wait_for_timeout(800)  # a few frames of the software renderer

    def comes_to_rest(self) -> bool:
        """Whether views stop drawing, after what they were asked to; COUNT_CALLS runs."""
        for _ in range(20):
            self.page.evaluate("calls.draws = 0")
            self.page.wait_for_timeout(500)
            if self.page.evaluate("calls.draws") == 0:
                return True
        return False

    def barriers(self) -> list[str]:
        """What axe finds serious or critical."""
        self.page.evaluate(AXE.read_text(encoding="utf-8"))
        found: list[dict[str, Any]] = self.page.evaluate("axe.run(document).then(result => result.violations)")
        return [
            f"{one['id']}: {one['help']}: {[node['html'][:120] for node in one['nodes'][:3]]}"
            for one in found
            if one["impact"] in ("serious", "critical")
        ]

    def barriers_everywhere(self) -> list[str]:
        """What axe finds in light and dark, on a desk and on a phone, and what sticks out to the side. The page stays so."""
        found = []
        before = self.page.viewport_size
        for size in (DESK, PHONE):
            self.page.set_viewport_size({"width": size["width"], "height": size["height"]})
            for scheme in ("light", "dark"):
                self.page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
                found += [f"{size['width']} {scheme}: {one}" for one in self.barriers()]
            if self.page.evaluate("document.documentElement.scrollWidth") > size["width"]:
                found.append(f"{size['width']}: the page sticks out to the side")
        self.page.emulate_media(color_scheme="light")
        if before:
            self.page.set_viewport_size(before)
        return found


@contextmanager
def visit(browser: Browser, url: str, *, size: dict[str, int] | None = None, dark: bool = False) -> Iterator[Visit]:
    """Open the server at `url`. At the end nothing may have gone wrong: script errors, requests to elsewhere, dialogs."""
    context = browser.new_context(
        base_url=url,
        viewport=size or DESK,
        color_scheme="dark" if dark else "light",
        accept_downloads=True,  # type: ignore[arg-type]
    )
    context.set_default_timeout(PATIENCE_MS)
    seen = Visit(context.new_page())

    def on_console(message: ConsoleMessage) -> None:
        if message.type == "error" and not any(known in message.text for known in EXPECTED):
            seen.wrong.append(message.text)

    def on_request(request: Request) -> None:
        if not request.url.startswith((url, "blob:", "data:")):
            seen.wrong.append(f"asked {request.url}")

    def on_dialog(dialog: Dialog) -> None:
        seen.wrong.append(f"dialog: {dialog.message}")
        dialog.dismiss()

    seen.page.on("console", on_console)
    seen.page.on("pageerror", lambda error: seen.wrong.append(str(error)))
    seen.page.on("request", on_request)
    seen.page.on("dialog", on_dialog)
    try:
        yield seen
    finally:
        context.close()
    assert seen.wrong == []


def write(path: Path, data: bytes) -> Path:
    """A file for the file dialog."""
    path.write_bytes(data)
    return path
