"""A full disk under the scratch space is a named failure that another attempt may be spared."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager

from core.errors import LimitError

_DISK_FULL = (errno.ENOSPC, errno.EDQUOT)


@contextmanager
def room_needed() -> Iterator[None]:
    """A full disk in this block is LimitError `storage.full`."""
    try:
        yield
    except OSError as error:
        if error.errno in _DISK_FULL:
            raise LimitError("storage.full", "the worker's disk is full; nothing of the input is at fault") from error
        raise
