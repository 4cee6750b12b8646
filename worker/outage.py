"""A database or object store that is away for minutes must not cost the work of an hour."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable
from typing import TypeVar

from core.errors import IntegumentError

logger = logging.getLogger(__name__)

PATIENCE_S = 600.0
FIRST_WAIT_S = 0.5
LONGEST_WAIT_S = 5.0

T = TypeVar("T")


def is_outage(error: IntegumentError) -> bool:
    """Whether the same act may succeed a little later."""
    return error.code in ("database.unavailable", "blobs.unavailable", "storage.full")


def sit_out(act: Callable[[], T], patience_s: float = PATIENCE_S, left: threading.Event | None = None) -> T:
    """Do `act`, again and again while the store is away; raises its last error after `patience_s`, or once `left` is set.

    `act` must be safe to repeat: writes under a fencing token are."""
    deadline = time.monotonic() + patience_s
    wait_s = FIRST_WAIT_S
    left = threading.Event() if left is None else left
    while True:
        try:
            return act()
        except IntegumentError as error:
            if not is_outage(error) or time.monotonic() + wait_s > deadline:
                raise
            logger.warning("%s; trying again in %.1f s", error, wait_s)
            if left.wait(wait_s):
                raise
        wait_s = min(2 * wait_s, LONGEST_WAIT_S)
