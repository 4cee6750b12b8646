from __future__ import annotations

import os
from pathlib import Path

import pytest

from sandbox.call import call
from sandbox.limits import Limits
from sandbox.nursery import Nursery


def test_a_child_has_nothing_it_does_not_need(limits: Limits, scratch: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INTEGUMENT_DATABASE_URL", "postgresql://user:secret@host/db")
    nursery = Nursery(preload=("tests.sandbox.targets",), threads=1)
    try:
        seen = call(nursery, "tests.sandbox.targets:describe_surroundings", {}, limits, scratch)
        nursery_pid = nursery.pid
    finally:
        nursery.stop()
    assert seen["session"] == seen["pid"] != nursery_pid
    assert seen["folder"] == str(scratch)
    assert seen["environment"]["TMPDIR"] == seen["temporary"] == str(scratch)
    assert seen["environment"]["OMP_NUM_THREADS"] == "1"
    assert "secret" not in str(seen["environment"])
    assert seen["stdin"] == "null"
    assert seen["descriptors"] == [0, 1, 2, 3, 4]  # 3: the event pipe; 4: the listing itself
    assert seen["umask"] == 0o077
    assert seen["no_new_privileges"]
    assert seen["open_files"] == limits.open_files
    assert seen["core"] == [0, 0]
    assert seen["oom_score"] == 500
    assert seen["niceness"] == min(19, os.nice(0) + 5), "those who answer come first"
    assert seen["scheduling"] == os.SCHED_BATCH


def test_a_child_has_a_network_of_its_own_where_the_kernel_allows_that(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    """Where it does not, the filter of calls still gives it no socket: tests/sandbox/test_escapes.py."""
    seen = call(nursery, "tests.sandbox.targets:describe_surroundings", {}, limits, scratch)
    refused = "keeps the host's network" in (scratch / "child.log").read_text()
    assert refused or seen["network"] != os.readlink("/proc/self/ns/net")
