"""How a running algorithm speaks to whoever waits for it. Cancelling is not asked here: the process is killed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, Protocol, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class RunEvent:
    """One thing a client may see while the job runs; `progress` counts 0-100 over the whole job."""

    kind: Literal["progress", "log"]
    progress: float
    phase: str
    message: str


class Checkpoints(Protocol):
    """Where outputs of finished steps are kept for another attempt of the same job."""

    def step(self, stage: str, make: Callable[[], T], depends: tuple[object, ...], log: Callable[[str], None]) -> T:
        """As `RunContext.checkpoint`."""
        ...


@dataclass(frozen=True, slots=True)
class RunContext:
    """A span of the job's progress bar, handed down from step to step. on_left: hears of files, see `leave`."""

    sink: Callable[[RunEvent], None]
    phase: str = "start"
    low: float = 0.0
    high: float = 100.0
    checkpoints: Checkpoints | None = None
    on_left: Callable[[Sequence[Mapping[str, str]]], None] | None = None

    def stage(self, phase: str, low: float, high: float) -> RunContext:
        """The sub-span from `low` to `high`, fractions of this one, named for the user (`shells: fat`); announced at once."""
        width = self.high - self.low
        inner = replace(self, phase=phase, low=self.low + low * width, high=self.low + high * width)
        inner.advance(0.0)
        return inner

    def advance(self, fraction: float, message: str = "") -> None:
        """Say how much of this span is done, 0 to 1, with numbers and units in the message."""
        done = self.low + min(max(fraction, 0.0), 1.0) * (self.high - self.low)
        self.sink(RunEvent("progress", round(done, 2), self.phase, message))

    def log(self, message: str) -> None:
        """One line for the job's log."""
        self.sink(RunEvent("log", round(self.low, 2), self.phase, message))

    def leave(self, files: Sequence[Mapping[str, str]]) -> None:
        """Say which files stay as outputs if the work is ended from outside from now on: by a limit, or a crash of a library."""
        if self.on_left is not None:
            self.on_left(files)

    def checkpoint(self, stage: str, make: Callable[[], T], *depends: object) -> T:
        """The output of a step: that of an attempt before if it was kept, else `make()`, kept for the next attempt.

        Needs:    `make` deterministic, its output decided by `stage` (a name unique within the software) and `depends`
                  alone; both made of frozen dataclasses and models of `core`, arrays, tuples, lists, dicts, text, numbers.
        Promises: the same value, bit for bit, whether it was made or found; arrays in C order.
        """
        if self.checkpoints is None:
            return make()
        return self.checkpoints.step(stage, make, depends, self.log)


SILENT = RunContext(sink=lambda _event: None)
