"""What a child has said, on its way to the job table: progress is merged, log lines are counted, phases are timed."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

MAX_LOG_LINES = 2000  # of one attempt; a flood of lines must not fill the database
MAX_TEXT = 2000  # characters of one message
MAX_PHASES = 100
FIRST_PHASE = "start"

NewEvent = tuple[str, Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class News:
    """What the job table does not know yet; None: nothing new."""

    progress: float | None = None
    phase: str | None = None
    message: str | None = None
    events: tuple[NewEvent, ...] = ()

    def __bool__(self) -> bool:
        return self != NO_NEWS


NO_NEWS = News()


class Progress:
    """Hears the child's messages, which may be anything at all, and keeps what can be shown."""

    def __init__(self, on_phase: Callable[[str], None] = lambda _phase: None) -> None:
        """`on_phase` hears of each phase as it begins."""
        self._on_phase = on_phase
        self._progress: float | None = None
        self._message: str | None = None
        self._phase = FIRST_PHASE
        self._phase_told: str | None = None
        self._events: list[NewEvent] = []
        self._lines = 0
        self._timings: dict[str, float] = {}
        self._phase_began = time.monotonic()

    @property
    def phase(self) -> str:
        """The present one."""
        return self._phase

    def hear(self, message: Mapping[str, Any]) -> None:
        """Take a message: {"kind": "progress", "progress", "phase", "message"} or {"kind": "log", "message"}; drop any other."""
        if message.get("kind") == "progress":
            self._hear_progress(message)
        elif message.get("kind") == "log":
            self._hear_line(_text(message.get("message")))

    def enter(self, phase: str) -> None:
        """A phase begins; the one before is over."""
        known = {*self._timings, self._phase}
        if phase == self._phase or (phase not in known and len(known) >= MAX_PHASES):
            return
        self._stop_clock()
        self._phase = phase
        self._on_phase(phase)

    def news(self) -> News:
        """What was heard since `told`."""
        phase = None if self._phase == self._phase_told else self._phase
        return News(self._progress, phase, self._message, tuple(self._events))

    def told(self, news: News) -> None:
        """The job table knows `news` now."""
        self._phase_told = self._phase
        self._progress = self._message = None
        del self._events[: len(news.events)]

    def timings_s(self) -> dict[str, float]:
        """Seconds per phase, the present one up to now."""
        self._stop_clock()
        return {phase: round(seconds, 3) for phase, seconds in self._timings.items()}

    def _hear_progress(self, message: Mapping[str, Any]) -> None:
        number = message.get("progress")
        if isinstance(number, int | float) and math.isfinite(number):
            self._progress = min(max(float(number), 0.0), 100.0)
        self._message = _text(message.get("message"))
        if phase := _text(message.get("phase")):
            self.enter(phase)

    def _hear_line(self, line: str) -> None:
        self._lines += 1
        if self._lines < MAX_LOG_LINES:
            self._events.append(("log", {"phase": self._phase, "message": line}))
        elif self._lines == MAX_LOG_LINES:
            self._events.append(("log", {"phase": self._phase, "message": f"the log ends here: {MAX_LOG_LINES} lines"}))

    def _stop_clock(self) -> None:
        now = time.monotonic()
        self._timings[self._phase] = self._timings.get(self._phase, 0.0) + now - self._phase_began
        self._phase_began = now


def _text(value: object) -> str:
    return value[:MAX_TEXT] if isinstance(value, str) else ""
