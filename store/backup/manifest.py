"""What a backup says of itself. A backup without a manifest that fits its files is none."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, StringConstraints

Sha256 = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]
FileName = Annotated[str, StringConstraints(pattern=r"^[a-z][a-z0-9_.]{0,80}$")]


class _Told(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class TableFile(_Told):
    """The rows of one table, a line of JSON each, packed by gzip."""

    file: FileName
    rows: int = Field(ge=0)
    sha256: Sha256


class BlobList(_Told):
    """The files the rows refer to, a line `sha256 bytes` each; they lie in the pool that all backups of a folder share."""

    file: FileName
    count: int = Field(ge=0)
    bytes: int = Field(ge=0)
    sha256: Sha256


class Manifest(_Told):
    """`revision` is of the tables, `version` of the software. missing, corrupt: files the store itself did not have any more."""

    format: Literal["integument-backup"] = "integument-backup"
    format_version: Literal[1] = 1
    version: str
    revision: str
    created_at: datetime
    tables: dict[str, TableFile]
    blobs: BlobList
    missing: tuple[Sha256, ...] = ()
    corrupt: tuple[Sha256, ...] = ()

    @property
    def rows(self) -> int:
        """Of all tables."""
        return sum(table.rows for table in self.tables.values())
