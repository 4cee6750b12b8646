"""What the tests let a child do; most of it is what a child must not get away with."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError
from core.schema.finding import Finding, Place, Severity
from sandbox.channel import Channel

Payload = dict[str, Any]
tempfile.gettempdir()  # as a library may that warms up: what it found is remembered


def echo(payload: Payload, channel: Channel) -> Payload:
    channel.send({"kind": "log", "message": "echo"})
    return payload


def describe_surroundings(payload: Payload, channel: Channel) -> Payload:
    return {
        "pid": os.getpid(),
        "session": os.getsid(0),
        "folder": str(Path.cwd()),
        "environment": dict(os.environ),
        "temporary": tempfile.gettempdir(),
        "descriptors": sorted(int(name) for name in os.listdir("/proc/self/fd")),
        "stdin": Path("/proc/self/fd/0").resolve().name,
        "umask": os.umask(0o077),
        "no_new_privileges": "NoNewPrivs:\t1" in Path("/proc/self/status").read_text(),
        "open_files": resource.getrlimit(resource.RLIMIT_NOFILE)[0],
        "core": resource.getrlimit(resource.RLIMIT_CORE),
        "oom_score": int(Path("/proc/self/oom_score_adj").read_text()),
        "niceness": os.getpriority(os.PRIO_PROCESS, 0),
        "scheduling": os.sched_getscheduler(0),
        "network": os.readlink("/proc/self/ns/net"),
    }


def raise_input_error(payload: Payload, channel: Channel) -> Payload:
    place = Place(mesh="skin", point_mm=(1.0, 2.0, 3.0), faces=(7,))
    finding = Finding(code="mesh.open", severity=Severity.ERROR, message="1 hole", count=1, places=(place,))
    error = InputError("skin.not_closed", "the skin has 1 hole", findings=(finding,), holes=1)
    error.outputs = ({"name": "report", "path": "report.json"},)
    raise error


def raise_key_error(payload: Payload, channel: Channel) -> Payload:
    return {"value": {}["nothing"]}


def leave_by_system_exit(payload: Payload, channel: Channel) -> Payload:
    raise SystemExit(3)


def leave_at_once(payload: Payload, channel: Channel) -> Payload:
    os._exit(7)


def segfault(payload: Payload, channel: Channel) -> Payload:
    ctypes.string_at(0)
    return {}


def abort_for_memory(payload: Payload, channel: Channel) -> Payload:
    os.write(2, b"terminate called after throwing an instance of 'std::bad_alloc'\n")
    os.abort()


def fill_numpy(payload: Payload, channel: Channel) -> Payload:
    return {"sum": float(np.ones(payload["bytes"] // 8).sum())}


def fill_bytearray(payload: Payload, channel: Channel) -> Payload:
    held = bytearray()
    while True:
        held += bytes(1 << 20)


def fill_with_family(payload: Payload, channel: Channel) -> Payload:
    """No process reaches the address space limit, but together they hold more than the job may."""
    for _ in range(payload["processes"]):
        if os.fork() == 0:
            held = bytearray(os.urandom(1 << 20)) * payload["mib_each"]
            time.sleep(60)
            os._exit(len(held) % 2)
    time.sleep(60)
    return {}


def loop_in_native_code(payload: Payload, channel: Channel) -> Payload:
    """One C call that never returns, holds the interpreter and lets no signal handler run."""
    channel.send({"kind": "progress", "progress": 10, "phase": "loop", "message": ""})
    return {"sum": sum(range(10**18))}


def write_large_file(payload: Payload, channel: Channel) -> Payload:
    with Path("large").open("wb") as file:
        while True:
            file.write(bytes(1 << 20))


def write_many_files(payload: Payload, channel: Channel) -> Payload:
    for number in range(10_000):
        Path(f"part{number}").write_bytes(bytes(1 << 20))
        time.sleep(0.01)
    return {}


def print_without_end(payload: Payload, channel: Channel) -> Payload:
    while True:
        print("x" * 4096)


def send_without_end(payload: Payload, channel: Channel) -> Payload:
    while True:
        channel.send({"kind": "log", "message": "x" * 1024})


def send_one_endless_line(payload: Payload, channel: Channel) -> Payload:
    while True:
        os.write(3, b"x" * 65536)


def send_nonsense(payload: Payload, channel: Channel) -> Payload:
    os.write(3, payload["line"].encode() + b"\n")
    return {}


def return_much(payload: Payload, channel: Channel) -> Payload:
    return {"text": "x" * payload["bytes"], "length": len(payload.get("text", ""))}


def return_not_a_number(payload: Payload, channel: Channel) -> Payload:
    return {"gap_mm": float("nan")}


def sleep(payload: Payload, channel: Channel) -> Payload:
    channel.send({"kind": "progress", "progress": 1, "phase": "sleep", "message": str(os.getpid())})
    time.sleep(payload["seconds"])
    return {"slept": payload["seconds"]}


def leave_grandchildren(payload: Payload, channel: Channel) -> Payload:
    """One in our group, one that flees into its own session, one that ignores every polite signal."""
    pids = []
    for flee in (False, True, True):
        pid = os.fork()
        if pid == 0:
            if flee:
                os.setsid()
            for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
                signal.signal(number, signal.SIG_IGN)
            time.sleep(60)
            os._exit(0)
        pids.append(pid)
    channel.send({"kind": "log", "message": " ".join(map(str, pids))})
    if payload.get("wait"):
        time.sleep(60)
    return {"pids": pids}
