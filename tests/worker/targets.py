"""What the children of the worker's tests do; payload["inputs"] says which."""

from __future__ import annotations

import errno
import os
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from core.errors import InputError
from core.processes.checkpoints.kept_steps import KeptSteps
from core.run import RunContext
from core.schema.finding import Finding, Severity
from sandbox.channel import Channel
from tests.sandbox import targets as hostile

Payload = dict[str, Any]


def run(payload: Payload, channel: Channel) -> Payload:
    """As core.processes.registry.run: does what inputs["act"] says and hands over a report."""
    inputs = payload["inputs"]
    channel.send({"kind": "log", "message": f"child {os.getpid()}"})
    channel.send({"kind": "progress", "progress": 5, "phase": "begin", "message": "begun"})
    act = inputs.get("act", "write")
    if act == "write":
        return _write(payload, channel)
    if act == "sleep":
        time.sleep(inputs["seconds"])
        return _write(payload, channel)
    if act == "crash_once":
        if Path(payload["out_dir"]).parent.suffix == ".1":  # the folder of the first claim; a child leaves no marks elsewhere
            hostile.segfault(payload, channel)
        return _write(payload, channel)
    if act == "refuse":
        _report(payload, "refused")
        error = InputError(
            "skin.not_closed",
            "the skin has 2 holes",
            findings=(Finding(code="mesh.open", severity=Severity.ERROR, message="2 holes", count=2),),
            holes=2,
        )
        error.outputs = (_output("report", payload["out_dir"] + "/report.json"),)
        raise error
    if act == "leave":
        (Path(payload["out_dir"]) / "report.json").write_text("half way")
        channel.send({"kind": "left", "outputs": [_output("record", payload["out_dir"] + "/report.json")]})
        return dict(getattr(hostile, inputs["end"])(inputs, channel))
    if act == "full_disk":
        raise OSError(errno.ENOSPC, "no room")
    if act == "lie":
        return {"verdict": "simulation_ready", "summary": "", "outputs": inputs["outputs"]} | inputs.get("extra", {})
    if act == "link":
        os.symlink(inputs["to"], Path(payload["out_dir"]) / "link")
        return {"verdict": "simulation_ready", "summary": "", "outputs": [_output("report", payload["out_dir"] + "/link")]}
    if act == "talk":
        for number in range(inputs["lines"]):
            channel.send({"kind": "log", "message": f"line {number}"})
            channel.send(
                {"kind": "progress", "progress": 100 * number / inputs["lines"], "phase": f"p{number % 3}", "message": ""}
            )
        return _write(payload, channel)
    if act == "steps":
        return _steps(payload, channel)
    result: Payload = getattr(hostile, act)(inputs, channel)
    return result


def _steps(payload: Payload, channel: Channel) -> Payload:
    """Three steps; ends or stops behind the first one of an attempt that found none, as inputs["end"] says."""
    inputs, asked = payload["inputs"], payload["checkpoints"]
    time.sleep(inputs.get("begin_after", 0))
    kept = {key: Path(path) for key, path in asked["kept"].items()}
    steps = KeptSteps(
        inputs.get("generation", "one"),
        kept,
        Path(asked["folder"]),
        lambda key, stage: channel.send({"kind": "checkpoint", "key": key, "stage": stage}),
        worth_s=asked["worth_s"],
        room_bytes=asked["room_bytes"],
    )
    run = RunContext(lambda event: channel.send({"kind": "log", "message": event.message}), checkpoints=steps)
    total = 0.0
    for number in range(3):
        total += float(run.checkpoint(f"step {number}", lambda number=number: np.sqrt(np.arange(1000.0) + number), number).sum())  # type: ignore[misc]
        if number == 0 and not kept and "end" in inputs:
            if inputs["end"] == "segfault":
                print('File "/srv/secret/place/core/shells/advance.py", line 7', file=sys.stderr, flush=True)
                hostile.segfault(payload, channel)
            time.sleep(60)
    _report(payload, f"{total!r}")
    return {
        "verdict": "simulation_ready",
        "summary": f"{total!r}",
        "outputs": [_output("report", payload["out_dir"] + "/report.json")],
    }


def _write(payload: Payload, channel: Channel) -> Payload:
    channel.send({"kind": "progress", "progress": 50, "phase": "work", "message": "half"})
    channel.send({"kind": "log", "message": "writing"})
    texts = [Path(mesh["path"]).read_text() for mesh in payload["meshes"].values()]
    _report(payload, " ".join([payload["process"], *texts]))
    return {
        "verdict": "simulation_ready",
        "summary": "all is well",
        "outputs": [_output("report", payload["out_dir"] + "/report.json")],
    }


def _report(payload: Payload, text: str) -> None:
    (Path(payload["out_dir"]) / "report.json").write_text(text)


def _output(name: str, path: str) -> dict[str, str]:
    return {"name": name, "path": path, "media_type": "application/json", "file_name": "report.json"}
