"""Run a compiled kernel over many rows on all cores; the kernels release the GIL."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

ROWS = 4096  # of one chunk: fixed, so results do not depend on the number of cores


def in_chunks(rows: int, work: Callable[[int, int], None]) -> None:
    """Call work(start, end) for consecutive chunks of `rows` rows; raises what a chunk raised. Few rows stay in this thread."""
    starts = range(0, rows, ROWS)
    if len(starts) <= 1:
        work(0, rows)
        return
    with ThreadPoolExecutor(max_workers=min(len(starts), len(os.sched_getaffinity(0)))) as threads:
        for done in [threads.submit(work, start, min(start + ROWS, rows)) for start in starts]:
            done.result()
