from __future__ import annotations

import math
import time
from typing import Any

import pytest

from worker.progress import MAX_LOG_LINES, MAX_PHASES, MAX_TEXT, NO_NEWS, News, Progress


def said(progress: float, phase: str, message: str = "") -> dict[str, Any]:
    return {"kind": "progress", "progress": progress, "phase": phase, "message": message}


def test_progress_is_merged_until_it_is_told() -> None:
    progress = Progress()
    progress.hear(said(10, "load"))
    progress.hear(said(20, "fat", "round 1"))
    progress.hear({"kind": "log", "message": "a line"})
    news = progress.news()
    assert news == News(20.0, "fat", "round 1", (("log", {"phase": "fat", "message": "a line"}),))
    assert progress.news() == news  # not told yet: a failed write loses nothing
    progress.told(news)
    assert progress.news() == NO_NEWS
    assert not progress.news()


def test_lines_heard_while_telling_are_kept() -> None:
    progress = Progress()
    progress.hear({"kind": "log", "message": "first"})
    news = progress.news()
    progress.hear({"kind": "log", "message": "second"})
    progress.told(news)
    assert [data["message"] for _, data in progress.news().events] == ["second"]


@pytest.mark.parametrize("number", [math.nan, math.inf, "3", None, [], {}])
def test_a_number_that_is_none_changes_nothing(number: object) -> None:
    progress = Progress()
    progress.hear(said(5, "load"))
    progress.hear({"kind": "progress", "progress": number, "phase": 7, "message": None})
    assert (progress.news().progress, progress.news().phase) == (5.0, "load")


@pytest.mark.parametrize(("number", "kept"), [(-5, 0.0), (250, 100.0), (True, 1.0)])
def test_progress_is_held_between_0_and_100(number: float, kept: float) -> None:
    progress = Progress()
    progress.hear(said(number, "load"))
    assert progress.news().progress == kept


def test_what_is_neither_progress_nor_log_is_dropped() -> None:
    progress = Progress()
    told = progress.news()
    progress.told(told)
    for message in ({}, {"kind": "status", "status": "successful"}, {"kind": ["log"]}):
        progress.hear(message)
    assert progress.news() == NO_NEWS


def test_texts_lines_and_phases_are_bounded() -> None:
    progress = Progress()
    for number in range(3 * MAX_LOG_LINES):
        progress.hear({"kind": "log", "message": "x" * (2 * MAX_TEXT)})
        progress.hear(said(1, f"phase {number}"))
    events = progress.news().events
    assert len(events) == MAX_LOG_LINES
    assert max(len(data["message"]) for _, data in events) == MAX_TEXT
    assert len(progress.timings_s()) <= MAX_PHASES


def test_phases_are_timed_and_their_seconds_add_up() -> None:
    started = time.monotonic()
    progress = Progress()
    progress.hear(said(0, "load"))
    time.sleep(0.05)
    progress.hear(said(10, "work"))
    time.sleep(0.02)
    progress.hear(said(20, "load"))
    time.sleep(0.05)
    timings = progress.timings_s()
    assert list(timings) == ["start", "load", "work"]
    assert timings["load"] >= 0.1
    assert timings["work"] >= 0.02
    assert sum(timings.values()) == pytest.approx(time.monotonic() - started, abs=0.01)
