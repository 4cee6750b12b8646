"""What was measured, against what was promised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Measure:
    """One number with its unit; `bound` says what it has to be, None: nothing was promised."""

    name: str
    value: float
    unit: str
    bound: float | None = None
    at_least: bool = False

    @property
    def holds(self) -> bool | None:
        """None without a bound."""
        if self.bound is None:
            return None
        return self.value >= self.bound if self.at_least else self.value <= self.bound

    def row(self) -> list[str]:
        """Of the table."""
        promised = "" if self.bound is None else f"{'≥' if self.at_least else '≤'} {self.bound:g} {self.unit}"
        return [self.name, f"{self.value:.4g} {self.unit}", promised, {None: "", True: "yes", False: "**no**"}[self.holds]]


@dataclass(frozen=True, slots=True)
class Part:
    """One measurement with all its numbers. series: (seconds, MiB) of the API's resident memory."""

    name: str
    measures: tuple[Measure, ...]
    errors: tuple[str, ...]
    rss_mib: tuple[tuple[float, float], ...] = ()


def latency(name: str, seconds: Sequence[float], p99_ms: float | None = None) -> tuple[Measure, ...]:
    """p50, p99 and the longest, in ms."""
    p50, p99, longest = 1000 * np.percentile(seconds, [50, 99, 100])
    return (
        Measure(f"{name}, p50", float(p50), "ms"),
        Measure(f"{name}, p99", float(p99), "ms", p99_ms),
        Measure(f"{name}, longest", float(longest), "ms"),
    )
