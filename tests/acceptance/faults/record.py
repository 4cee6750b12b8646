"""The table of a run: what was done to the lab, and what it did."""

from __future__ import annotations

import json
import statistics
from collections import Counter
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from tests.acceptance.faults.census import Census
from tests.acceptance.faults.plan import Plan

SHOWN = 40


def describe_run(
    plan: Plan, census: Census, done: Counter[str], missed: int, refusals: Counter[str], seconds: float
) -> dict[str, Any]:
    """Everything, as JSON."""
    return {
        "seed": plan.seed,
        "seconds": round(seconds, 1),
        "faults": dict(sorted(done.items())),
        "faults that found nothing to hit": missed,
        "answers after all retries": dict(refusals.most_common()),
        **vars(census),
    }


def table(plan: Plan, census: Census, done: Counter[str], missed: int, refusals: Counter[str], seconds: float) -> str:
    """For people, in Markdown."""
    counts: dict[str, object] = {
        "seed": plan.seed,
        "jobs sent": census.requests,
        "faults": f"{sum(done.values())} ({missed} more found nothing to hit)",
        "seconds": round(seconds),
        "accepted": census.accepted,
        **{name: len(items) for name, items in census.wrong().items()},
        "ended": _counted(census.by_status.items()),
        "attempts": _counted((f"{attempts}:", number) for attempts, number in sorted(census.by_attempts.items())),
        "unwanted blobs swept": census.left_blobs,
        "killed worker's job waits again after": _spread(census.requeued_s),
        "killed worker's job runs again after": _spread(census.recovered_s),
        "answers clients had to repeat by themselves": _counted(refusals.most_common()) or "none",
    }
    rows = [f"| {name} | {value} |" for name, value in counts.items()]
    faults = [f"| {name} | {number} |" for name, number in sorted(done.items())]
    return "\n".join(("| | |", "|---|---|", *rows, "", "| fault | times |", "|---|---|", *faults))


def complaints(census: Census) -> list[str]:
    """Each thing that must not be, in a line."""
    return [f"{name}: {item}" for name, items in census.wrong().items() for item in items[:SHOWN]]


def write_record(folder: Path, seed: int, told: dict[str, Any], text: str) -> None:
    """`<seed>.json` and `<seed>.md`."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{seed}.json").write_text(json.dumps(told, indent=1, default=str) + "\n")
    (folder / f"{seed}.md").write_text(text + "\n")


def _counted(items: Iterable[tuple[object, int]]) -> str:
    return ", ".join(f"{name} {number}" for name, number in items)


def _spread(seconds: list[float]) -> str:
    if not seconds:
        return "no worker was killed with a job in hand"
    return f"{statistics.median(seconds):.1f} s in the middle, {max(seconds):.1f} s at most, of {len(seconds)}"
