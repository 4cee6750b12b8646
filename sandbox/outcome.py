"""How a child ended, as its parent sees it."""

from __future__ import annotations

import os
import signal
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.errors import CLASSES_BY_FAULT, IntegumentError, InternalError, LimitError
from core.schema.finding import Finding
from sandbox.child_main import out_of_memory
from sandbox.confinement import LOG_NAME
from sandbox.limits import Limits
from sandbox.messages import Message

LOG_TAIL_BYTES = 4096
OUT_OF_MEMORY_WORDS = (b"bad_alloc", b"out of memory", b"Cannot allocate memory")  # last words of native code without memory


@dataclass(frozen=True, slots=True)
class Outcome:
    """Exactly one of `result` and `error` is set; `outputs` are the files an error came with."""

    result: dict[str, Any] | None
    error: IntegumentError | None
    outputs: tuple[dict[str, Any], ...]
    exit_code: int  # negative: the signal that ended it
    peak_bytes: int  # resident, of the child and its descendants together


def conclude(last: Message | None, report: Message | None, limits: Limits, scratch: Path) -> Outcome:
    """Weigh the child's last message against how it died; `report` None: the nursery died with it."""
    if report is None:
        lost = InternalError("nursery.lost", "the process that starts the work was lost, and the work with it")
        return Outcome(None, lost, (), -signal.SIGKILL, 0)
    exit_code, peak_bytes = int(report["exit_code"]), int(report["max_rss_bytes"])
    if last is not None and last["kind"] == "result" and isinstance(last.get("result"), dict):
        return Outcome(last["result"], None, (), exit_code, peak_bytes)
    if last is not None and last["kind"] == "error":
        return Outcome(None, revive(last.get("error")), tuple(last.get("outputs") or ()), exit_code, peak_bytes)
    return Outcome(None, _explain_end(exit_code, limits, scratch), (), exit_code, peak_bytes)


def revive(description: object) -> IntegumentError:
    """The error that `IntegumentError.describe()` told of; what a broken child made up becomes `child.protocol_broken`."""
    try:
        if not isinstance(description, dict):
            raise TypeError(f"an error is an object, not {type(description).__name__}")
        findings = tuple(Finding.model_validate(finding) for finding in description.get("findings", ()))
        error = CLASSES_BY_FAULT[description["fault"]](str(description["code"]), str(description["message"]), findings=findings)
        error.facts = {str(name): fact for name, fact in description.get("facts", {}).items()}
        return error
    except (KeyError, TypeError, ValueError) as problem:
        return protocol_broken(str(problem))


def protocol_broken(detail: str) -> InternalError:
    """The error for a child that does not keep to the form of its messages."""
    return InternalError("child.protocol_broken", f"the work answered in a form nobody understands: {detail}")


def out_of_cpu_time(limits: Limits) -> LimitError:
    """The error for a child that computed longer than `limits.cpu_s`."""
    return LimitError(
        "limit.cpu_time",
        f"the work computes longer than the {limits.cpu_s} s of processor time this server allows for one job",
        limit_s=limits.cpu_s,
    )


def out_of_wall_time(limits: Limits) -> LimitError:
    """The error for a child that ran longer than `limits.wall_s`."""
    return LimitError(
        "limit.wall_time",
        f"the work runs longer than the {limits.wall_s:g} s this server allows for one job",
        limit_s=limits.wall_s,
    )


def _explain_end(exit_code: int, limits: Limits, scratch: Path) -> IntegumentError:
    """The child said nothing: all we have is its exit code and its last words."""
    if exit_code == -signal.SIGXCPU:
        return out_of_cpu_time(limits)
    if exit_code == -signal.SIGABRT and any(words in log_tail(scratch) for words in OUT_OF_MEMORY_WORDS):
        return out_of_memory(limits, "native code gave up")
    if exit_code < 0:
        name = signal.Signals(-exit_code).name
        hint = "; perhaps the machine ran out of memory" if name == "SIGKILL" else ""
        return InternalError("child.crashed", f"the work was ended by signal {name}{hint}", signal=name)
    return InternalError("child.crashed", f"the work ended without a result, exit code {exit_code}", exit_code=exit_code)


def log_tail(scratch: Path) -> bytes:
    """The last words of the child; empty when it had none, or put something else in the place of its log."""
    try:
        handle = os.open(scratch / LOG_NAME, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:
        return b""
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        return b""
    with os.fdopen(handle, "rb") as log:
        log.seek(0, os.SEEK_END)
        log.seek(max(0, log.tell() - LOG_TAIL_BYTES))
        return log.read()
