"""Entry of the nursery process: `python -m sandbox.nursery_main SOCKET_FD MODULE...`; started by sandbox.nursery only."""

from __future__ import annotations

import fcntl
import importlib
import logging
import os
import signal
import socket
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from core.errors import InternalError
from sandbox.apprentice import Step
from sandbox.fork_server import ForkServer, owner_is_gone
from sandbox.kernel import PR_SET_CHILD_SUBREAPER, set_process_flag
from sandbox.leisure import Leisure, settle_memory
from sandbox.log_lines import LOG_FORMAT, configure_logging

logger = logging.getLogger("sandbox.nursery")


def main(arguments: Sequence[str]) -> None:
    """Preload, then serve until the owner goes."""
    configure_logging(os.environ.get(LOG_FORMAT, "auto"), str)
    owner = socket.socket(fileno=int(arguments[0]))
    set_process_flag(PR_SET_CHILD_SUBREAPER, 1)
    die_with(owner)
    steps: list[Step] = []
    refusal = preload(arguments[1:], steps)
    signal.signal(signal.SIGIO, signal.SIG_IGN)
    fcntl.fcntl(owner, fcntl.F_SETFL, fcntl.fcntl(owner, fcntl.F_GETFL) & ~os.O_ASYNC)
    settle_memory()
    if owner_is_gone(owner):
        return
    owner.send(b"ready")  # stays unread: that it is there is the message
    ForkServer(owner, refusal, Leisure(steps)).serve()


def die_with(owner: socket.socket) -> None:
    """End at once when the owner goes while modules are still loading: nobody reads the socket then, so the kernel signals."""

    def look(_number: int, _frame: object) -> None:
        if owner_is_gone(owner):
            os._exit(0)

    signal.signal(signal.SIGIO, look)
    fcntl.fcntl(owner, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(owner, fcntl.F_SETFL, fcntl.fcntl(owner, fcntl.F_GETFL) | os.O_ASYNC)
    look(signal.SIGIO, None)


def preload(modules: Sequence[str], steps: list[Step]) -> dict[str, Any] | None:
    """Import `modules`, run their `warm_up()`, add their `leisure_steps()`; None, or the error that every request will get."""
    started = time.monotonic()
    for name in modules:
        try:
            module = importlib.import_module(name)
            if hasattr(module, "warm_up"):
                module.warm_up()
            if hasattr(module, "leisure_steps"):
                steps += module.leisure_steps()
        except BaseException as error:  # the module's author decides what it raises; we must live to say so
            logger.exception("preload of %s failed", name)
            return InternalError(
                "nursery.preload_failed", f"the processes cannot be loaded: {name}: {type(error).__name__}: {error}", module=name
            ).describe()
    threads = sum(1 for _ in Path("/proc/self/task").iterdir())
    if threads > 1:
        logger.warning("%d threads after the preload: a fork copies only one of them", threads)
    logger.info("warm after %.2f s: %s", time.monotonic() - started, ", ".join(modules) or "nothing to load")
    return None


if __name__ == "__main__":
    main(sys.argv[1:])
