"""A file that a child process may have made, opened without trusting it."""

from __future__ import annotations

import errno
import os
import stat
from io import BufferedReader
from pathlib import Path

from core.errors import InternalError


def open_regular_file(path: Path) -> BufferedReader:
    """For reading; links are not followed and a pipe does not make us wait.

    Raises InternalError `blob.not_a_file`, OSError if it cannot be read."""
    try:
        handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        if error.errno in (errno.ELOOP, errno.ENXIO):
            raise InternalError("blob.not_a_file", f"{path.name} is not a regular file") from error
        raise
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise InternalError("blob.not_a_file", f"{path.name} is not a regular file")
    return os.fdopen(handle, "rb")
