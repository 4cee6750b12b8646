"""A short fault run of a fixed seed. `make faults` is the long one, docs/faults.md tells what both count."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.acceptance.faults.plan import MENU, draw_plan

ROOT = Path(__file__).resolve().parents[3]
LIMIT_S = 900


def test_a_seed_stands_for_one_plan() -> None:
    assert draw_plan(7, 50, 1.0, 20) == draw_plan(7, 50, 1.0, 20)
    assert draw_plan(7, 50, 1.0, 20) != draw_plan(8, 50, 1.0, 20)


def test_a_long_plan_has_every_fault_and_a_key_for_every_job() -> None:
    plan = draw_plan(1, 200, 2.0, 80)
    assert {(kind, target) for kind, targets, *_ in MENU for target in targets} >= {(one.kind, one.target) for one in plan.faults}
    assert len({(one.kind, one.target.partition(" of ")[0].partition("-")[0]) for one in plan.faults}) == len(MENU)
    assert len({one.key for one in plan.requests}) == 200
    assert [one.at_s for one in plan.faults] == sorted(one.at_s for one in plan.faults)


@pytest.mark.timeout(LIMIT_S)
def test_nothing_accepted_is_lost_doubled_spoilt_or_stuck() -> None:
    # a process of its own: it moves to mounts of its own, for disks that can be filled
    ran = subprocess.run(
        [
            sys.executable,
            "-m",
            "tests.acceptance.faults",
            "--short",
            "--seed",
            "4",
            "--jobs",
            "20",
            "--faults",
            "8",
            "--pace",
            "0.7",
        ],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=LIMIT_S,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr[-8000:]
    assert "| accepted | 20 |" in ran.stdout
