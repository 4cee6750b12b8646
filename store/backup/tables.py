"""The tables as the database has them, whatever the revision: a backup does not depend on what this code expects."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import JSON, MetaData, Table, func, select
from sqlalchemy.orm import Session

OF_MIGRATIONS = "alembic_version"
EXPENDABLE = frozenset({"leaders", "metric_tallies", "metric_totals", "turns", "workers"})
"""What tells of processes alone, and is begun anew after a restore."""


def reflect_tables(session: Session) -> Sequence[Table]:
    """Parents first."""
    metadata = MetaData()
    metadata.reflect(session.connection())
    for table in metadata.tables.values():
        for column in table.columns:
            if isinstance(column.type, JSON):
                column.type = JSON(none_as_null=True)
    return [table for table in metadata.sorted_tables if table.name != OF_MIGRATIONS]


def count_rows(session: Session) -> dict[str, int]:
    """Of every table."""
    return {
        table.name: session.execute(select(func.count()).select_from(table)).scalar_one() for table in reflect_tables(session)
    }
