"""How a running algorithm speaks to whoever waits for it. Cancelling is not asked here: the process is killed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class RunEvent:
    """One thing a client may see while the job runs; `progress` counts 0-100 over the whole job."""

    kind: Literal["progress", "log"]
    progress: float
    phase: str
    message: str


@dataclass(frozen=True, slots=True)
class RunContext:
    """A span of the job's progress bar, handed down from step to step."""

    sink: Callable[[RunEvent], None]
    phase: str = "start"
    low: float = 0.0
    high: float = 100.0

    def stage(self, phase: str, low: float, high: float) -> RunContext:
        """The sub-span from `low` to `high`, fractions of this one, named for the user (`shells: fat`); announced at once."""
        width = self.high - self.low
        inner = RunContext(self.sink, phase, self.low + low * width, self.low + high * width)
        inner.advance(0.0)
        return inner

    def advance(self, fraction: float, message: str = "") -> None:
        """Say how much of this span is done, 0 to 1, with numbers and units in the message."""
        done = self.low + min(max(fraction, 0.0), 1.0) * (self.high - self.low)
        self.sink(RunEvent("progress", round(done, 2), self.phase, message))

    def log(self, message: str) -> None:
        """One line for the job's log."""
        self.sink(RunEvent("log", round(self.low, 2), self.phase, message))


SILENT = RunContext(sink=lambda _event: None)
