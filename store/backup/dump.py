"""All tables as they are at one moment, while everybody goes on writing."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

from sqlalchemy import Table, select
from sqlalchemy.orm import Session

from store.backup.manifest import TableFile
from store.backup.row_text import to_text
from store.backup.tables import reflect_tables
from store.backup.vault import digest_of

ROWS_AT_A_TIME = 500


def dump_tables(session: Session, folder: Path) -> dict[str, TableFile]:
    """A file per table. `session` must be a `Database.snapshot`; what an earlier call left in the folder is overwritten."""
    return {table.name: _dump(session, table, folder / f"{table.name}.jsonl.gz") for table in reflect_tables(session)}


def _dump(session: Session, table: Table, path: Path) -> TableFile:
    rows = 0
    ordered = select(table).order_by(*table.primary_key.columns)  # the same rows make the same file
    with path.open("wb") as raw:
        os.fchmod(raw.fileno(), 0o600)
        with gzip.GzipFile("", "wb", 6, raw, mtime=0) as packed:
            for row in session.execute(ordered, execution_options={"yield_per": ROWS_AT_A_TIME}).mappings():
                packed.write(to_text(dict(row)).encode() + b"\n")
                rows += 1
        raw.flush()
        os.fsync(raw.fileno())
    return TableFile(file=path.name, rows=rows, sha256=digest_of(path))
