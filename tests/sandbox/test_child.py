from __future__ import annotations

import time
from pathlib import Path

import pytest

from sandbox.child import MAX_WAITING_EVENTS, READ_BYTES, Child
from sandbox.limits import MIB, Limits
from sandbox.nursery import Nursery
from sandbox.outcome import Outcome
from tests.sandbox.ending import wait_for_end

TARGETS = "tests.sandbox.targets:"


def wait(child: Child, timeout_s: float = 10.0) -> Outcome:
    deadline = time.monotonic() + timeout_s
    while (outcome := child.outcome()) is None:
        assert time.monotonic() < deadline, "the child did not end"
        child.events(0.1)
    return outcome


def first_event(child: Child) -> dict[str, object]:
    events = child.events(10.0)
    assert events, "the child said nothing"
    return events[0]


def test_an_outcome_says_how_it_ended(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with nursery.spawn(TARGETS + "fill_numpy", {"bytes": 64 * MIB}, limits, scratch) as child:
        outcome = wait(child)
    assert outcome.result == {"sum": 8 * MIB}
    assert outcome.error is None
    assert outcome.exit_code == 0
    assert 64 * MIB < outcome.peak_bytes < 512 * MIB


def test_outputs_of_a_failed_process_come_along(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with nursery.spawn(TARGETS + "raise_input_error", {}, limits, scratch) as child:
        outcome = wait(child)
    assert outcome.error is not None
    assert outcome.outputs == ({"name": "report", "path": "report.json"},)


def test_kill_ends_a_native_loop_at_once(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with nursery.spawn(TARGETS + "loop_in_native_code", {}, limits, scratch) as child:
        assert first_event(child)["phase"] == "loop"
        started = time.monotonic()
        child.kill()
        outcome = wait(child)
        assert time.monotonic() - started < 1.0
        assert outcome.exit_code == -9
        child.kill()  # a second time harms nobody
    assert wait_for_end([child.pid], 0.0) == []


@pytest.mark.parametrize("how", ["kill", "end", "close"])
def test_grandchildren_end_with_the_child(nursery: Nursery, limits: Limits, scratch: Path, how: str) -> None:
    with nursery.spawn(TARGETS + "leave_grandchildren", {"wait": how != "end"}, limits, scratch) as child:
        pids = [int(pid) for pid in str(first_event(child)["message"]).split()]
        if how == "kill":
            child.kill()
        if how != "close":
            wait(child)
    assert wait_for_end([child.pid, *pids], 0.0) == []  # already gone when the outcome is known


def test_memory_counts_the_whole_family(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with nursery.spawn(TARGETS + "fill_with_family", {"processes": 2, "mib_each": 80}, limits, scratch) as child:
        deadline = time.monotonic() + 10
        while child.memory_bytes() < 160 * MIB:
            assert time.monotonic() < deadline, f"{child.memory_bytes()} bytes seen"
            child.events(0.05)
        child.kill()
        assert wait(child).peak_bytes > 160 * MIB
        assert child.memory_bytes() == 0


def test_a_flood_of_events_waits_in_the_child(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with nursery.spawn(TARGETS + "send_without_end", {}, limits, scratch) as child:
        for _ in range(200):
            assert child.outcome() is None  # looks, but takes no events away
        assert len(child.events()) <= MAX_WAITING_EVENTS + READ_BYTES // 1024


def test_nothing_a_child_said_before_its_end_is_lost(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with nursery.spawn(TARGETS + "echo", {}, limits, scratch) as child:
        assert wait_for_end([child.pid]) == []
        assert child.outcome() is None  # the event first
        assert [event["message"] for event in child.events(1.0)] == ["echo"]
        assert wait(child).result == {}
