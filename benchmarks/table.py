"""Rows as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain


def print_table(title: str, head: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """A heading and a table on standard output, every row as soon as it is there."""
    print(f"\n### {title}\n")
    for row in chain((head, ["---"] * len(head)), rows):
        print("| " + " | ".join(row) + " |", flush=True)
    print(flush=True)


def percent(shares: Sequence[float], digits: int = 2) -> str:
    """`99.80 % / 99.51 %`."""
    return " / ".join(f"{100 * share:.{digits}f} %" for share in shares)


def thousands(number: int) -> str:
    """`107,024`."""
    return f"{number:,}"
