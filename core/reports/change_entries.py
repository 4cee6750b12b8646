"""Changes as a page shows them: a sentence, a few numbers, and long lists folded away as tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from core.reports.facts import fact_value, facts_of, heading

MOST_ROWS = 100
SAID_ELSEWHERE = ("mesh", "message", "what", "change", "kind")


@dataclass(frozen=True, slots=True)
class ChangeTable:
    """A list of alike facts; `more` rows were left out."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    more: int


@dataclass(frozen=True, slots=True)
class ChangeEntry:
    """One change: on which mesh, what, numbers as (name, value), tables."""

    mesh: str
    words: str
    facts: tuple[tuple[str, str], ...]
    tables: tuple[ChangeTable, ...]


def change_entries(changes: Sequence[Mapping[str, Any]]) -> tuple[ChangeEntry, ...]:
    """In the order of the report; what is a list of objects becomes a table."""
    return tuple(_entry(change) for change in changes)


def _entry(change: Mapping[str, Any]) -> ChangeEntry:
    tables = {key: value for key, value in change.items() if _is_table(value)}
    facts = {key: value for key, value in change.items() if key not in tables and key not in SAID_ELSEWHERE}
    words = str(change.get("message") or change.get("what") or change.get("change") or change.get("kind") or "")
    return ChangeEntry(
        mesh=str(change.get("mesh", "")),
        words=words,
        facts=tuple(facts_of(facts)),
        tables=tuple(_table(key, rows) for key, rows in tables.items()),
    )


def _is_table(value: object) -> bool:
    return isinstance(value, list | tuple) and len(value) > 0 and all(isinstance(row, Mapping) for row in value)


def _table(title: str, rows: Sequence[Mapping[str, Any]]) -> ChangeTable:
    columns = tuple(dict.fromkeys(key for row in rows for key in row))
    shown = tuple(tuple(fact_value(column, row.get(column)) for column in columns) for row in rows[:MOST_ROWS])
    return ChangeTable(title.replace("_", " "), tuple(map(heading, columns)), shown, len(rows) - len(shown))
