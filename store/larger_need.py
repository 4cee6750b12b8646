"""What the next attempt is expected to need after one that may have ended for want of memory."""

from __future__ import annotations

from store.job import JobFailure

FACTOR = 1.5


def larger_need(expected_bytes: int, failure: JobFailure, peak_bytes: int | None) -> int:
    """One and a half times what was seen, never less than before; unchanged if memory had nothing to do with it.

    The kernel's own killer takes the child, which looks like any SIGKILL, or with the control group the whole worker."""
    if failure.code == "limit.memory" or failure.facts.get("signal") == "SIGKILL":
        return max(expected_bytes, int(FACTOR * (peak_bytes or expected_bytes)))
    if failure.code == "worker.lost":
        return int(FACTOR * expected_bytes)
    return expected_bytes
