"""What a child prints is for its last words; it must not fill the disk its neighbours work on."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from sandbox.confinement import LOG_NAME

LOG_BYTES = 8 * 1024**2


def cap_log(scratch: Path, limit_bytes: int = LOG_BYTES) -> bool:
    """Let the log start over when it has become longer; True if it did.

    The child writes at its end, wherever that is, and may have put anything in its place: a plain file of one name is cut."""
    try:
        log = os.open(scratch / LOG_NAME, os.O_WRONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:  # none yet, or no file any more
        return False
    try:
        told = os.fstat(log)
        if not stat.S_ISREG(told.st_mode) or told.st_nlink != 1 or told.st_size <= limit_bytes:
            return False
        os.ftruncate(log, 0)
        return True
    finally:
        os.close(log)
