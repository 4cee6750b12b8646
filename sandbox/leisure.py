"""What the nursery learns between requests: steps worth doing once for all children, but not needed for the first."""

from __future__ import annotations

import ctypes
import logging
import os
import signal
from collections import deque
from collections.abc import Sequence
from contextlib import suppress

from sandbox.apprentice import Step, fork_apprentice
from sandbox.frozen_heap import freeze_heap
from sandbox.kernel_cache import KernelNotKeptError, kept_kernels_only
from sandbox.visible_files import known_files

logger = logging.getLogger("sandbox.nursery")


class Leisure:
    """One step at a time while nobody asks for a child. Nothing is compiled here, since who asks would have to wait for that:
    where kernels are not on disk an apprentice compiles them beside the work, and the step is taken once more after that."""

    def __init__(self, steps: Sequence[Step]) -> None:
        self._steps = deque(steps)
        self._cold: list[Step] = []
        self._had_apprentice = False
        self.pid: int | None = None  # of the apprentice, while it works

    @property
    def is_due(self) -> bool:
        """Whether there is a step to take now."""
        return bool(self._steps)

    def take_step(self) -> None:
        """The next one."""
        step = self._steps.popleft()
        try:
            with kept_kernels_only():
                step()
        except KernelNotKeptError:
            self._cold.append(step)
        except Exception:  # a job that needs it says why
            logger.exception("%s failed ahead of its first use", step.__name__)
        if not self._steps:
            self._send_apprentice()
            settle_memory()

    def hear_of_end(self, pid: int) -> bool:
        """Whether the process that ended was the apprentice; then its steps are due again."""
        if pid != self.pid:
            return False
        self.pid = None
        self._steps.extend(self._cold)
        self._cold.clear()
        return True

    def end(self) -> None:
        """Of the apprentice; the caller reaps it."""
        self._steps.clear()
        if self.pid is not None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, signal.SIGKILL)

    def _send_apprentice(self) -> None:
        """Once, if anything has to be compiled."""
        if not self._cold:
            logger.info("all that can be done ahead is done")
        elif self._had_apprentice:
            logger.warning("kernels are not kept on disk (see NUMBA_CACHE_DIR): each job compiles what it needs")
        else:
            self._had_apprentice = True
            try:
                self.pid = fork_apprentice(tuple(self._cold))
            except OSError as error:
                logger.warning("kernels are not compiled ahead of their first use: %s", error)


def settle_memory() -> None:
    """Before a fork: what is loaded stays where it is; what is free goes back to the kernel, so that there is less to copy."""
    known_files.cache_clear()
    known_files()
    freeze_heap()  # and keeps the collector of every child from copying our pages
    with suppress(AttributeError):  # glibc alone has it
        ctypes.CDLL(None).malloc_trim(0)
