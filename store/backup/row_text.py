"""Rows as JSON, the same for both databases: what was SQLite may come back as PostgreSQL, and the other way round."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import DateTime, Table

_PLAIN = (str, int, float, bool, list, dict, type(None))


def to_text(row: Mapping[str, Any]) -> str:
    """One line. Raises TypeError for a kind of value this form does not know."""
    return json.dumps({name: _to_json(value) for name, value in row.items()}, ensure_ascii=False, allow_nan=False)


def from_text(line: str, table: Table) -> dict[str, Any]:
    """The inverse, for a table that has these columns."""
    told: dict[str, Any] = json.loads(line)
    return {
        name: datetime.fromisoformat(value) if value is not None and isinstance(table.c[name].type, DateTime) else value
        for name, value in told.items()
    }


def _to_json(value: Any) -> Any:
    if isinstance(value, datetime):
        return (value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)).isoformat()  # SQLite tells no zone
    if not isinstance(value, _PLAIN):
        raise TypeError(f"a backup has no form for {type(value).__name__}")
    return value
