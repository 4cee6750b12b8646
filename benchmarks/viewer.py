"""What the 3D view of the page costs the main thread: `python -m benchmarks.viewer [FACES...]`. Prints a table for docs/web.md.

A real API, Debian's Chromium, two closed spheres one in the other as the surfaces of a job, turned by dragging, then cut
while the plane is dragged. There is no graphics card here: a process of Chromium's own draws by the processor, so frames per
second say nothing; what the page's main thread takes for a frame, its calls and its memory do."""

from __future__ import annotations

import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from playwright.sync_api import CDPSession, Page, expect

from core.mesh import Mesh
from store.settings import Settings
from tests.acceptance.service import binary_stl
from tests.api.live import serving
from tests.valkey import running_valkey
from tests.web.browser import COUNT_CALLS, chromium, visit
from tests.web.tracing import traced

FACES = (100_000, 990_000)  # in two closed surfaces; above 500,000 each the server thins them
SETTLE_MS = 3_000
VIEW = {"width": 1280, "height": 640}  # small, since the processor draws it; the main thread does the same for a large one
STEPS = 40
STEP_MS = 250
PATIENCE_MS = 300_000


@dataclass(frozen=True, slots=True)
class Cost:
    """Of one movement of STEPS steps. Milliseconds are of the page's main thread, counted in its own processor time."""

    frames: int
    frame_ms: float
    worst_frame_ms: float
    input_ms: float
    draws_per_frame: float
    new_buffers: int
    bytes_per_frame: float


def heap_bytes(session: CDPSession) -> float:
    """In use, after what nobody holds is gone."""
    session.send("HeapProfiler.collectGarbage")
    return float(session.send("Runtime.getHeapUsage")["usedSize"])


def measure(page: Page, session: CDPSession, move: Any) -> Cost:
    """Do one movement and say what it took."""
    page.evaluate("calls.draws = calls.buffers = 0")
    before = heap_bytes(session)
    with traced(session) as events:
        move()
        drawn = -1
        while drawn != (drawn := page.evaluate("calls.draws")):  # the processor is slow to draw, and frames wait for it
            page.wait_for_timeout(SETTLE_MS)
    after = float(session.send("Runtime.getHeapUsage")["usedSize"])  # with the garbage: what frames leave behind
    counted = page.evaluate("({...calls})")
    frames = [event["tdur"] / 1000 for event in events if event["name"] == "FireAnimationFrame" and "tdur" in event]
    kinds = ("pointermove", "mousemove", "input")
    inputs = [
        event["tdur"] / 1000
        for event in events
        if event["name"] == "EventDispatch" and event["args"]["data"]["type"] in kinds and "tdur" in event
    ]
    return Cost(
        frames=len(frames),
        frame_ms=median(frames),
        worst_frame_ms=max(frames),
        input_ms=max(inputs, default=0.0),
        draws_per_frame=counted["draws"] / len(frames),
        new_buffers=counted["buffers"],
        bytes_per_frame=max(after - before, 0.0) / len(frames),
    )


def orbit(page: Page) -> None:
    """Drag across the view."""
    box = page.locator(".viewer canvas").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + 150
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(STEPS):
        page.mouse.move(x + 3 * step, y + step % 7)
    page.mouse.up()


def drag_plane(page: Page) -> None:
    """Move the cut through the body, by its slider."""
    slider = page.get_by_label("Place of the cut on z in mm")
    slider.focus()
    for _ in range(STEPS):
        page.keyboard.press("ArrowRight")
        page.wait_for_timeout(STEP_MS)  # keys pressed while a frame is drawn would become one


def ball(radius_mm: float, faces: int) -> Mesh:
    """A closed sphere of about so many faces."""
    rings = max(int((faces / 4) ** 0.5), 3)
    sectors = 2 * rings
    polar = np.pi * np.arange(1, rings) / rings
    around = 2 * np.pi * np.arange(sectors) / sectors
    grid = [np.outer(np.sin(polar), np.cos(around)), np.outer(np.sin(polar), np.sin(around)), np.outer(np.cos(polar), around**0)]
    vertices = np.concatenate([[[0, 0, 1]], np.stack(grid, axis=-1).reshape(-1, 3), [[0, 0, -1]]])
    this, following = np.arange(sectors), (np.arange(sectors) + 1) % sectors
    top = np.column_stack([np.zeros_like(this), 1 + this, 1 + following])
    bottom = len(vertices) - 1 - sectors
    parts = [top, np.column_stack([bottom + following, bottom + this, np.full_like(this, len(vertices) - 1)])]
    for ring in range(rings - 2):
        a, b = 1 + ring * sectors + this, 1 + ring * sectors + following
        parts += [np.column_stack([a, a + sectors, b]), np.column_stack([b, a + sectors, b + sectors])]
    return Mesh.of(radius_mm * vertices, np.concatenate(parts))


def run(meshes: dict[str, Mesh]) -> dict[str, Cost]:
    """Show them as the surfaces of a job, turn them, and drag a cut through them."""
    with tempfile.TemporaryDirectory() as folder, running_valkey() as valkey:
        settings = Settings(data_dir=Path(folder) / "data", broker_url=valkey.url, port=0)
        with serving(settings) as live, chromium() as browser, visit(browser, live.url, size=VIEW) as seen:
            job = live.successful({name: (binary_stl(mesh), "model/stl", f"{name}.stl") for name, mesh in meshes.items()})
            seen.page.add_init_script(COUNT_CALLS)
            seen.page.set_default_timeout(PATIENCE_MS)
            session = seen.page.context.new_cdp_session(seen.page)
            seen.page.goto(f"/#/jobs/{job.id}")
            seen.page.wait_for_selector('.viewer[data-ready="true"]', timeout=PATIENCE_MS)
            expect(seen.page.get_by_label("Show fat")).to_be_visible(timeout=PATIENCE_MS)
            seen.page.wait_for_timeout(SETTLE_MS)
            costs = {"turned": measure(seen.page, session, lambda: orbit(seen.page))}
            seen.page.get_by_role("button", name="Cut across z").click()
            seen.page.wait_for_timeout(SETTLE_MS)
            costs["cut, turned"] = measure(seen.page, session, lambda: orbit(seen.page))
            costs["cut dragged"] = measure(seen.page, session, lambda: drag_plane(seen.page))
            seen.page.wait_for_timeout(SETTLE_MS)
            calm = seen.page.evaluate("calls.draws = 0, new Promise(then => setTimeout(() => then(calls.draws), 1000))")
            if calm:
                raise RuntimeError(f"{calm} draw calls while nothing moved")
    return costs


def main() -> None:
    """Print one table."""
    print("| faces | movement | frames | ms per frame | worst | ms per input | draw calls | new buffers | kB per frame |")
    print("|---|---|---|---|---|---|---|---|---|")
    for faces in [int(word) for word in sys.argv[1:]] or FACES:
        meshes = {"skin": ball(100.0, faces // 2), "fat": ball(95.0, faces // 2)}
        shown = sum(len(mesh.faces) for mesh in meshes.values())
        for name, cost in run(meshes).items():
            print(
                f"| {shown:,} | {name} | {cost.frames} | {cost.frame_ms:.2f} | {cost.worst_frame_ms:.1f} | "
                f"{cost.input_ms:.1f} | {cost.draws_per_frame:.1f} | {cost.new_buffers} | {cost.bytes_per_frame / 1000:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
