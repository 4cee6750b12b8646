"""What one look found."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class Health(StrEnum):
    """`wrong` needs an operator; `warning` may need one soon."""

    OK = "ok"
    WARNING = "warning"
    WRONG = "wrong"


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """`said` has the numbers; `advice` is empty where nothing is to be done."""

    part: str
    health: Health
    said: str
    advice: str = ""


def fine(part: str, said: str) -> Diagnosis:
    """Nothing to do."""
    return Diagnosis(part, Health.OK, said)


def warning(part: str, said: str, advice: str) -> Diagnosis:
    """It works, but."""
    return Diagnosis(part, Health.WARNING, said, advice)


def wrong(part: str, said: str, advice: str) -> Diagnosis:
    """It does not."""
    return Diagnosis(part, Health.WRONG, said, advice)


def is_wrong(found: Iterable[Diagnosis]) -> bool:
    """Whether an operator has to act."""
    return any(diagnosis.health is Health.WRONG for diagnosis in found)


def size(number: float) -> str:
    """`1.5 GiB`."""
    for unit in ("B", "KiB", "MiB", "GiB"):
        if abs(number) < 1024:
            return f"{number:.0f} {unit}" if unit == "B" else f"{number:.1f} {unit}"
        number /= 1024
    return f"{number:.1f} TiB"
