"""Start a server for the tests that dies with them, even if they are killed."""

from __future__ import annotations

import pwd
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import IO

# Runs in a fresh interpreter instead of preexec_fn, which is unsafe beside threads: changes the user, asks the kernel for
# the signal on the parent's death (a change of user would cancel it, so that comes first), becomes the server.
_TETHER = """
import ctypes, os, sys
death_signal, uid, gid, *command = sys.argv[1:]
if os.geteuid() == 0 and uid != "0":
    os.setgroups([])
    os.setgid(int(gid))
    os.setuid(int(uid))
ctypes.CDLL(None).prctl(1, int(death_signal))
os.chdir("/")
os.execv(command[0], command)
"""


def start_tethered(
    command: Sequence[str | Path], *, death_signal: signal.Signals, user: str = "", log: IO[bytes]
) -> subprocess.Popen[bytes]:
    """Start `command` as `user` (root only; else as we are) with its output in `log`."""
    entry = pwd.getpwnam(user) if user else None
    uid, gid = (entry.pw_uid, entry.pw_gid) if entry else (0, 0)
    return subprocess.Popen(
        [sys.executable, "-ISc", _TETHER, str(int(death_signal)), str(uid), str(gid), *map(str, command)],
        stdin=subprocess.DEVNULL,
        stdout=log,
        stderr=log,
    )
