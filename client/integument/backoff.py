"""When to try again, and when to give up."""

from __future__ import annotations

import random
import time

from integument.errors import ServerError

LONGEST_PAUSE_S = 8.0
LONGEST_RETRY_AFTER_S = 120.0  # a server that asks for more will not be back within this call


class Backoff:
    """Counts failures in a row; each pause doubles, with jitter, so that many clients do not return in step."""

    def __init__(self, retries: int, first_pause_s: float) -> None:
        self._retries = retries
        self._first_pause_s = first_pause_s
        self._failures = 0

    def reset(self) -> None:
        """Something arrived: the count starts again."""
        self._failures = 0

    def pause(self, error: ServerError, *, repeatable: bool = True) -> None:
        """Sleep before the next try; a Retry-After is honoured.

        Raises: `error` itself, if trying again is no use, is not safe (`repeatable` false: only what certainly did not
        reach the server is sent twice), or was done often enough.
        """
        worthwhile = error.transient if repeatable else error.untouched
        asked_s = error.retry_after_s or 0.0
        if not worthwhile or self._failures >= self._retries or asked_s > LONGEST_RETRY_AFTER_S:
            raise error
        own_s = min(LONGEST_PAUSE_S, self._first_pause_s * 2**self._failures) * random.uniform(0.5, 1.0)  # noqa: S311 jitter
        self._failures += 1
        time.sleep(max(own_s, asked_s))
