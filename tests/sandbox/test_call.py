from __future__ import annotations

import dataclasses
import os
import time
from pathlib import Path
from typing import Any

import pytest

from core.errors import InputError, IntegumentError, InternalError, LimitError
from sandbox.call import call
from sandbox.confinement import LOG_NAME
from sandbox.limits import MIB, Limits
from sandbox.nursery import Nursery

TARGETS = "tests.sandbox.targets:"


def test_a_result_comes_back_and_events_are_heard(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    heard: list[dict[str, Any]] = []
    payload = {"text": "äöü", "list": [1, 2.5, None]}
    assert call(nursery, TARGETS + "echo", payload, limits, scratch, heard.append) == payload
    assert heard == [{"kind": "log", "message": "echo"}]


def test_the_childs_error_is_raised_with_all_it_carries(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with pytest.raises(InputError, match="the skin has 1 hole") as raised:
        call(nursery, TARGETS + "raise_input_error", {}, limits, scratch)
    assert raised.value.code == "skin.not_closed"
    assert raised.value.facts == {"holes": 1}
    assert raised.value.findings[0].places[0].faces == (7,)


@pytest.mark.parametrize(
    ("target", "kind", "code", "fact"),
    [
        ("raise_key_error", InternalError, "child.raised", ("exception", "KeyError")),
        ("leave_by_system_exit", InternalError, "child.raised", ("exception", "SystemExit")),
        ("return_not_a_number", InternalError, "child.raised", ("exception", "ValueError")),
        ("leave_at_once", InternalError, "child.crashed", ("exit_code", 7)),
        ("segfault", InternalError, "child.crashed", ("signal", "SIGSEGV")),
        ("abort_for_memory", LimitError, "limit.memory", ("limit_bytes", 256 * MIB)),
        ("fill_bytearray", LimitError, "limit.memory", ("limit_bytes", 256 * MIB)),
        ("fill_numpy", LimitError, "limit.memory", ("limit_bytes", 256 * MIB)),
        ("fill_with_family", LimitError, "limit.memory", ("limit_bytes", 256 * MIB)),
        ("write_large_file", LimitError, "limit.file_size", ("limit_bytes", 32 * MIB)),
        ("write_many_files", LimitError, "limit.file_size", ("limit_bytes", 32 * MIB)),
        ("print_without_end", LimitError, "limit.file_size", ("limit_bytes", 32 * MIB)),
        ("send_one_endless_line", InternalError, "child.protocol_broken", None),
        ("no_such_function", InternalError, "child.raised", ("exception", "AttributeError")),
    ],
)
def test_whatever_a_child_does_its_parent_gets_a_named_error(
    nursery: Nursery,
    limits: Limits,
    scratch: Path,
    target: str,
    kind: type[IntegumentError],
    code: str,
    fact: tuple[str, object] | None,
) -> None:
    payload = {"bytes": 2**40, "processes": 3, "mib_each": 100}
    with pytest.raises(kind) as raised:
        call(nursery, TARGETS + target, payload, dataclasses.replace(limits, memory_bytes=256 * MIB), scratch)
    assert raised.value.code == code
    if fact is not None:
        assert raised.value.facts[fact[0]] == fact[1]
    other = scratch.parent / "other"
    other.mkdir()
    assert call(nursery, TARGETS + "echo", {"next": 1}, limits, other) == {"next": 1}  # nobody else noticed


def test_an_endless_native_loop_is_cut_by_processor_time(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with pytest.raises(LimitError, match="1 s of processor time") as raised:
        call(nursery, TARGETS + "loop_in_native_code", {}, dataclasses.replace(limits, cpu_s=1), scratch)
    assert raised.value.code == "limit.cpu_time"


@pytest.mark.parametrize("target", ["loop_in_native_code", "sleep", "send_without_end"])
def test_what_runs_too_long_is_cut_by_the_clock(nursery: Nursery, limits: Limits, scratch: Path, target: str) -> None:
    started = time.monotonic()
    with pytest.raises(LimitError) as raised:
        call(nursery, TARGETS + target, {"seconds": 60}, dataclasses.replace(limits, wall_s=0.5), scratch)
    assert raised.value.code == "limit.wall_time"
    assert time.monotonic() - started < 3


@pytest.mark.parametrize("line", ["no json", "[1]", '{"kind":"error","error":{"code":"x"}}', '{"kind":"error","error":3}'])
def test_nonsense_from_a_child_is_an_error_not_a_crash(nursery: Nursery, limits: Limits, scratch: Path, line: str) -> None:
    with pytest.raises(InternalError) as raised:
        call(nursery, TARGETS + "send_nonsense", {"line": line}, limits, scratch)
    assert raised.value.code == "child.protocol_broken"


def test_messages_larger_than_any_buffer_pass_both_ways(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    result = call(nursery, TARGETS + "return_much", {"bytes": 8 * MIB, "text": "y" * 4 * MIB}, limits, scratch)
    assert (len(result["text"]), result["length"]) == (8 * MIB, 4 * MIB)


def test_the_traceback_is_in_the_childs_log(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    with pytest.raises(InternalError):
        call(nursery, TARGETS + "raise_key_error", {}, limits, scratch)
    assert "KeyError: 'nothing'" in (scratch / LOG_NAME).read_text()
    with pytest.raises(InternalError):
        call(nursery, TARGETS + "segfault", {}, limits, scratch)
    assert "Fatal Python error: Segmentation fault" in (scratch / LOG_NAME).read_text()


def test_a_listener_that_raises_ends_the_child(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    def refuse(event: dict[str, Any]) -> None:
        pids.append(int(event["message"]))
        raise LookupError("enough")

    pids: list[int] = []
    with pytest.raises(LookupError):
        call(nursery, TARGETS + "sleep", {"seconds": 60}, limits, scratch, refuse)
    with pytest.raises(ProcessLookupError):
        os.kill(pids[0], 0)


def test_a_missing_scratch_folder_is_an_error(nursery: Nursery, limits: Limits, tmp_path: Path) -> None:
    with pytest.raises(InternalError) as raised:
        call(nursery, TARGETS + "echo", {}, limits, tmp_path / "absent")
    assert raised.value.code == "child.crashed"
