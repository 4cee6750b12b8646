"""What a taken-over child would try. Each act returns the name of the error it met, or what it got."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import socket
import subprocess
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from sandbox.channel import Channel

Payload = dict[str, Any]
PTRACE_ATTACH = 16
CLONE_NEWUSER = 0x1000_0000


def try_all(payload: Payload, channel: Channel) -> Payload:
    """act -> what came of it. payload: "secret", "input", "foreign", "socket" (paths), "port", "owner_pid"."""
    parent = os.getppid()
    owner = payload["owner_pid"]
    acts: dict[str, Callable[[], object]] = {
        "read its input": lambda: Path(payload["input"]).read_text(),
        "write its input": lambda: Path(payload["input"]).write_text("changed"),
        "write its own file": lambda: Path("own").write_text("own"),
        "rename its own file": lambda: str(Path("own").rename("renamed")),
        "make its own folder": lambda: Path("folder").mkdir(),
        "move into its own folder": lambda: str(Path("renamed").rename("folder/own")),
        "make a link": lambda: Path("link").symlink_to(payload["secret"]),
        "link a secret here": lambda: os.link(payload["secret"], "hard"),
        "read a secret": lambda: Path(payload["secret"]).read_text(),
        "read another job": lambda: Path(payload["foreign"]).read_text(),
        "list another job": lambda: os.listdir(Path(payload["foreign"]).parent),
        "write into another job": lambda: Path(payload["foreign"]).write_text("changed"),
        "change another job": lambda: os.chmod(payload["foreign"], 0o777),
        "date another job": lambda: os.utime(payload["foreign"], (0, 0)),
        "truncate another job": lambda: os.truncate(payload["foreign"], 0),
        "remove another job": lambda: Path(payload["foreign"]).unlink(),
        "write beside its folder": lambda: Path("../beside").write_text("x"),
        "write to /tmp": lambda: Path("/tmp/integument-escape").write_text("x"),
        "write to shared memory": lambda: Path("/dev/shm/integument-escape").write_text("x"),
        "write into our code": lambda: (Path(__file__).parent / "escaped.py").write_text("x"),
        "read the passwords": lambda: Path("/etc/passwd").read_text(),
        "read the environment of the nursery": lambda: Path(f"/proc/{parent}/environ").read_text(),
        "read the environment of the owner": lambda: Path(f"/proc/{owner}/environ").read_text(),
        "read the memory of the owner": lambda: Path(f"/proc/{owner}/mem").open("rb").close(),
        "list the files of the owner": lambda: os.listdir(f"/proc/{owner}/fd"),
        "look at the command of the owner": lambda: Path(f"/proc/{owner}/cmdline").read_text(),
        "trace the nursery": lambda: _library("ptrace", PTRACE_ATTACH, parent),
        "read into the nursery": lambda: _library("process_vm_readv", parent, None, 0, None, 0, 0),
        "kill the nursery": lambda: os.kill(parent, signal.SIGKILL),
        "kill the owner": lambda: os.kill(owner, signal.SIGKILL),
        "kill everybody": lambda: os.kill(-1, signal.SIGKILL),
        "stop the owner": lambda: signal.pidfd_send_signal(os.pidfd_open(owner), signal.SIGSTOP),
        "limit the owner": lambda: resource.prlimit(owner, resource.RLIMIT_NOFILE, (3, 3)),
        "pin the owner": lambda: os.sched_setaffinity(owner, {0}),
        "outlive the nursery": lambda: _library("prctl", 1, 0, 0, 0, 0),
        "call a server": lambda: socket.create_connection(("127.0.0.1", payload["port"]), timeout=2).close(),
        "call a socket that is a file": lambda: _call_file(payload["socket"]),
        "listen": lambda: socket.socket().listen(),
        "ask for a name": lambda: socket.getaddrinfo("localhost.invalid", 80),
        "run a program": lambda: subprocess.run(["/bin/true"], check=True),
        "become a program": lambda: os.execv("/bin/true", ["/bin/true"]),
        "fork": _fork,
        "leave the namespaces": lambda: _library("unshare", CLONE_NEWUSER),
        "lift its limits": lambda: resource.setrlimit(resource.RLIMIT_CPU, (resource.RLIM_INFINITY, resource.RLIM_INFINITY)),
        "become root": lambda: os.setuid(0) if os.getuid() else os.setuid(12345),
        "start a thread": _thread,
        "end itself politely": lambda: os.kill(os.getpid(), 0),
    }
    return {name: _outcome(act) for name, act in acts.items()}


def fork_without_end(payload: Payload, channel: Channel) -> Payload:
    """As many processes as it gets."""
    while True:
        _fork()


def _outcome(act: Callable[[], object]) -> str:
    try:
        return f"done: {act()}"
    except Exception as error:  # noqa: BLE001 - the name of whatever stands against it is the result
        return type(error).__name__


def _library(function: str, *arguments: object) -> int:
    library = ctypes.CDLL(None, use_errno=True)
    result: int = getattr(library, function)(*arguments)
    if result < 0:
        raise OSError(ctypes.get_errno(), function)
    return result


def _call_file(path: str) -> None:
    with socket.socket(socket.AF_UNIX) as caller:
        caller.connect(path)


def _fork() -> None:
    if os.fork() == 0:
        os._exit(0)


def _thread() -> str:
    said: list[str] = []
    thread = threading.Thread(target=said.append, args=("a thread",))
    thread.start()
    thread.join()
    return said[0]
