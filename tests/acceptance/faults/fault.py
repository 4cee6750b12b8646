"""What can go wrong, each with a beginning and mostly an end."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Kind(StrEnum):
    """What is done to the target; the words of the plan and of the table."""

    KILL = "kill"  # SIGKILL; started again when the fault ends
    PAUSE = "pause"  # SIGSTOP, SIGCONT when the fault ends
    RESTART = "restart"  # stopped in good order and started again
    EMPTY = "empty"  # killed, and what it kept is gone
    CUT = "cut"  # connections are broken, new ones refused
    HANG = "hang"  # connections are taken, nothing is carried
    REFUSE = "refuse"  # every request is answered 500
    FILL = "fill"  # the disk is full until the fault ends
    JUMP = "jump"  # the clock is off by hours until the fault ends


@dataclass(frozen=True, slots=True)
class Fault:
    """`at_s` counts from the start of the load. `draw` picks among several (children, connections) in a way of the seed's own;
    `hours` is how far a clock jumps."""

    at_s: float
    lasts_s: float
    kind: Kind
    target: str
    draw: int
    hours: float = 0.0

    @property
    def ends_s(self) -> float:
        """When it is undone."""
        return self.at_s + self.lasts_s

    def __str__(self) -> str:
        jump = f" by {self.hours:+.1f} h" if self.kind is Kind.JUMP else ""
        return f"{self.at_s:7.2f} s  {self.kind} {self.target}{jump} for {self.lasts_s:.1f} s"
