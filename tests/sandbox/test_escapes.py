"""A child that somebody took over tries what it can. Held on every kernel our tests run on; older ones say what they lack."""

from __future__ import annotations

import os
import socket
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.errors import InternalError
from sandbox.call import call
from sandbox.call_filter import can_filter_calls
from sandbox.landlock import landlock_version
from sandbox.limits import Limits
from sandbox.nursery import Nursery
from tests.sandbox.ending import wait_for_end

SECRET = "postgresql://user:secret@host/db"
ALLOWED = {
    "read its input",
    "write its own file",
    "rename its own file",
    "make its own folder",
    "move into its own folder",
    "start a thread",
    "end itself politely",
}


def test_this_kernel_can_confine() -> None:
    """The tests below show nothing elsewhere: run them on Linux 6.12 or later, x86_64 or aarch64, with Landlock switched on."""
    assert landlock_version() >= 6
    assert can_filter_calls()


@pytest.fixture(scope="module")
def tried(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What came of every act; the child ran with the limits of production, its files in a folder of their own."""
    place = tmp_path_factory.mktemp("escapes")
    for name in ("scratch", "foreign"):
        (place / name).mkdir()
    paths = {"secret": place / "settings.env", "input": place / "input.stl", "foreign": place / "foreign" / "mesh"}
    for path in paths.values():
        path.write_text(SECRET)
    with (
        pytest.MonkeyPatch.context() as patch,
        socket.create_server(("127.0.0.1", 0)) as server,
        socket.socket(socket.AF_UNIX) as file_server,
    ):
        patch.chdir(place)  # a short name: the path of a socket has 107 bytes
        file_server.bind("server.sock")
        file_server.listen()
        patch.setenv("INTEGUMENT_DATABASE_URL", SECRET)
        payload: dict[str, Any] = {name: str(path) for name, path in paths.items()}
        payload |= {"port": server.getsockname()[1], "socket": str(place / "server.sock"), "owner_pid": os.getpid()}
        nursery = Nursery(("tests.sandbox.escapes",))
        try:
            told = call(nursery, "tests.sandbox.escapes:try_all", payload, Limits(), place / "scratch", readable=[paths["input"]])
            environment = Path(f"/proc/{nursery.pid}/environ").read_text()
        finally:
            nursery.stop()
    assert "secret" not in environment
    assert [path.read_text() for path in paths.values()] == [SECRET] * 3
    assert not (place / "beside").exists()
    return told


def test_nothing_but_its_own_folder_and_inputs_is_within_reach(tried: dict[str, str]) -> None:
    """OSError: PermissionError and its kind; SubprocessError and gaierror come from the same refusal."""
    got = {act for act, outcome in tried.items() if outcome.startswith("done")}
    assert got == ALLOWED, {act: outcome for act, outcome in tried.items() if act in got ^ ALLOWED}


def test_what_is_refused_is_refused_by_the_kernel(tried: dict[str, str]) -> None:
    refused = {act: outcome for act, outcome in tried.items() if act not in ALLOWED}
    kinds = set(refused.values())
    assert kinds <= {"PermissionError", "OSError", "gaierror", "ValueError"}, refused


def test_a_fork_bomb_does_not_go_off(limits: Limits, scratch: Path) -> None:
    nursery = Nursery(("tests.sandbox.escapes",))
    try:
        with pytest.raises(InternalError, match="PermissionError") as raised:
            call(nursery, "tests.sandbox.escapes:fork_without_end", {}, replace(limits, forks=False), scratch)
        assert raised.value.code == "child.raised"
    finally:
        nursery.stop()


def test_where_forks_are_let_through_a_bomb_ends_with_its_memory_or_time(nursery: Nursery, limits: Limits, scratch: Path) -> None:
    """The bound that is left where the kernel has no filter of calls."""
    family = {"processes": 8, "mib_each": 200}
    with nursery.spawn("tests.sandbox.targets:fill_with_family", family, limits, scratch) as child:
        child.events(0.2)
        pid = child.pid
    assert wait_for_end([pid]) == []


def test_a_host_that_cannot_confine_may_be_told_to_refuse(limits: Limits, scratch: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The stand-in for an old kernel is a machine the filter does not know."""
    (scratch / "old_kernel.py").write_text("from sandbox import call_filter\ncall_filter.MACHINES.clear()\n")
    monkeypatch.syspath_prepend(scratch)
    strict = Nursery(("old_kernel", "tests.sandbox.targets"), require_confinement=True)
    lenient = Nursery(("old_kernel", "tests.sandbox.targets"))
    try:
        with pytest.raises(InternalError, match="no filter of system calls") as raised:
            call(strict, "tests.sandbox.targets:echo", {"a": 1}, limits, scratch)
        assert raised.value.code == "confinement.missing"
        assert call(lenient, "tests.sandbox.targets:echo", {"a": 1}, limits, scratch) == {"a": 1}
    finally:
        strict.stop()
        lenient.stop()
    assert (scratch / "child.log").read_text().count("not confined: no filter") == 2
