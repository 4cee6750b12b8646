"""Rows of a backup into tables that have none."""

from __future__ import annotations

import gzip
from collections.abc import Iterator
from itertools import islice
from typing import Any

from sqlalchemy import Table, delete, func, insert, select
from sqlalchemy.orm import Session

from core.errors import InternalError
from store.backup.manifest import Manifest
from store.backup.row_text import from_text
from store.backup.tables import EXPENDABLE, reflect_tables
from store.backup.vault import Vault

ROWS_AT_A_TIME = 500
FENCE = 1000
"""Added to every fencing token: a worker of the lost database that still lives may hold tokens the backup does not know of."""


def load_tables(session: Session, vault: Vault, name: str, manifest: Manifest) -> None:
    """All of them in the caller's transaction. The tables must be those of the manifest's revision, and empty.

    Raises InternalError `backup.corrupt`."""
    tables = reflect_tables(session)
    if set(manifest.tables) != {table.name for table in tables}:
        raise InternalError("backup.corrupt", f"backup {name} does not have the tables of its revision {manifest.revision}")
    for table in reversed(tables):
        session.execute(delete(table))  # the default workspace, which comes with the tables
    for table in tables:
        if table.name in EXPENDABLE:
            continue
        told = manifest.tables[table.name]
        path = vault.require(name, told.file, told.sha256)
        with gzip.open(path, "rt", encoding="utf-8") as lines:
            loaded = _load(session, table, lines)
        if loaded != told.rows:
            raise InternalError("backup.corrupt", f"{told.file} of backup {name} has {loaded} rows, not {told.rows}")
        if session.get_bind().dialect.name == "postgresql":
            _count_on(session, table)


def _load(session: Session, table: Table, lines: Iterator[str]) -> int:
    loaded = 0
    while batch := [_fenced(from_text(line, table)) for line in islice(lines, ROWS_AT_A_TIME)]:
        session.execute(insert(table), batch)
        loaded += len(batch)
    return loaded


def _fenced(row: dict[str, Any]) -> dict[str, Any]:
    return row | {"lease_token": row["lease_token"] + FENCE} if "lease_token" in row else row


def _count_on(session: Session, table: Table) -> None:
    """Numbers PostgreSQL gives out go on behind those that were loaded."""
    for column in table.primary_key.columns:
        sequence = session.execute(select(func.pg_get_serial_sequence(table.name, column.name))).scalar_one()
        if sequence is not None:
            session.execute(
                select(func.setval(sequence, select(func.coalesce(func.max(column), 0) + 1).scalar_subquery(), False))
            )
