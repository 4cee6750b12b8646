"""A copy of the nursery that compiles kernels to disk beside the work, so that the nursery is never away when a job comes."""

from __future__ import annotations

import logging
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence

from sandbox.confinement import give_way
from sandbox.kernel import PR_SET_PDEATHSIG, set_process_flag
from sandbox.spare import FIRST_FD, forget_signals

logger = logging.getLogger("sandbox.nursery")

Step = Callable[[], object]


def fork_apprentice(steps: Sequence[Step]) -> int:
    """Its process id; it does what it can, and dies with the nursery. Raises OSError.

    It is as trusted as the nursery: the steps are our own code on our own data."""
    nursery_pid = os.getpid()
    sys.stdout.flush()
    sys.stderr.flush()
    pid = os.fork()
    if pid:
        return pid
    try:
        forget_signals()
        os.setsid()
        set_process_flag(PR_SET_PDEATHSIG, signal.SIGKILL)
        os.closerange(FIRST_FD, os.sysconf("SC_OPEN_MAX"))
        give_way()  # as a job does, not more: on a busy host it would never be done, and each job compile for itself
        if os.getppid() == nursery_pid:
            for step in steps:
                _do(step)
    finally:
        os._exit(0)


def _do(step: Step) -> None:
    began = time.process_time()
    try:
        step()
    except Exception:  # one that fails must not keep the others from being done; a job that needs it says why
        logger.exception("%s failed ahead of its first use", step.__name__)
        return
    logger.info("%s is ready after %.1f s of processor time", step.__name__.strip("_"), time.process_time() - began)
