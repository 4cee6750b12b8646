"""Ties the parts to the supervisor, so that nothing outlives it, not even its own SIGKILL. Linux only."""

from __future__ import annotations

import os
import signal

from sandbox.kernel import PR_SET_CHILD_SUBREAPER, PR_SET_PDEATHSIG, set_process_flag


def tie_to_parent(parent_pid: int) -> None:
    """Ask the kernel to kill this process when the parent's thread that forked it ends; the tie survives exec.

    Runs in the child between fork and exec. Raises: OSError; ends the child at once if the parent is gone already.
    """
    set_process_flag(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent_pid:
        os._exit(1)


def adopt_orphans(adopt: bool) -> None:
    """Become the parent of every descendant that loses its own, so that it can be found and ended. Raises: OSError."""
    set_process_flag(PR_SET_CHILD_SUBREAPER, int(adopt))
