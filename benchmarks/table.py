"""Rows as Markdown."""

from __future__ import annotations

from collections.abc import Sequence


def print_table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """A heading and a table, at once on standard output."""
    print(f"\n### {title}\n")
    for row in (head, ["---"] * len(head), *rows):
        print("| " + " | ".join(row) + " |")
    print(flush=True)


def percent(shares: Sequence[float], digits: int = 2) -> str:
    """`99.80 % / 99.51 %`."""
    return " / ".join(f"{100 * share:.{digits}f} %" for share in shares)


def thousands(number: int) -> str:
    """`107,024`."""
    return f"{number:,}"
