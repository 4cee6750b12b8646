"""What the main thread of a page does, in its own processor time: how busy the machine is does not change it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from playwright.sync_api import CDPSession

FRAMES_AND_INPUT = "devtools.timeline"
MAIN_THREAD = "CrRendererMain"
TASKS = "disabled-by-default-devtools.timeline"


@contextmanager
def traced(session: CDPSession, categories: str = FRAMES_AND_INPUT) -> Iterator[list[dict[str, Any]]]:
    """The events of the renderer while the block ran, filled in at its end; `tdur` is in microseconds of processor time."""
    events: list[dict[str, Any]] = []
    done: list[bool] = []
    session.on("Tracing.dataCollected", lambda told: events.extend(told["value"]))
    session.on("Tracing.tracingComplete", lambda _told: done.append(True))
    session.send("Tracing.start", {"categories": categories, "transferMode": "ReportEvents"})
    yield events
    session.send("Tracing.end")
    while not done:
        session.send("Runtime.evaluate", {"expression": "0"})


def main_thread_tasks_ms(events: list[dict[str, Any]]) -> list[float]:
    """Of every task of a renderer's main thread, traced as TASKS."""
    mains = {(one["pid"], one["tid"]) for one in events if one["name"] == "thread_name" and one["args"]["name"] == MAIN_THREAD}
    return [one.get("tdur", 0) / 1000 for one in events if one["name"] == "RunTask" and (one["pid"], one["tid"]) in mains]
