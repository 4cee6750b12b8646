"""What a crashed child leaves as evidence, fit for its owner's eyes: names of files, not where they are."""

from __future__ import annotations

import re
import signal
from pathlib import Path

from sandbox.outcome import Outcome, log_tail
from store.lost_attempt import LastWords

_PLACE = re.compile(r"/(?:[^/\s\"':,;()]+/)+(?=[^/\s\"':,;()]+/[^/\s\"':,;()]+)")
"""Of a path all folders but the last one."""


def last_words(outcome: Outcome, phase: str, folder: Path) -> LastWords:
    """Signal, memory and the end of the log of the child that worked in `folder` and was in `phase`."""
    return LastWords(
        phase=phase,
        signal=signal.Signals(-outcome.exit_code).name if outcome.exit_code < 0 else None,
        peak_memory_bytes=outcome.peak_bytes or None,
        log=without_places(log_tail(folder).decode(errors="replace")),
    )


def without_places(text: str) -> str:
    """`/srv/app/core/shells/advance.py` -> `…/shells/advance.py`."""
    return _PLACE.sub("…/", text)
