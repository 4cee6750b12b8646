"""What every admin command has at hand."""

from __future__ import annotations

import getpass
import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from store.audit import DONE, Audit, AuditEntry
from store.database import Database
from store.quotas import Quotas
from store.settings import Settings
from store.workspace import WorkspaceId

Document = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Desk:
    """The database of the settings, and where answers go: one JSON document, or text for people, on stdout."""

    settings: Settings
    db: Database
    as_json: bool

    @property
    def quotas(self) -> Quotas:
        """As the API has them."""
        return Quotas(self.db, default_bytes=self.settings.quota_bytes, default_jobs=self.settings.quota_jobs)

    @property
    def actor(self) -> str:
        """Who is at work, for the audit log."""
        try:
            return f"admin:{getpass.getuser()}"
        except (KeyError, OSError):  # a user of a container may have a number only
            return "admin"

    def note_act(self, action: str, subject: str, workspace: WorkspaceId, key_id: str | None = None) -> None:
        """For the audit log, once it is done."""
        Audit(self.db).write([AuditEntry(datetime.now(UTC), self.actor, key_id, workspace, action, subject, DONE)])

    def show(self, document: Document) -> None:
        """One thing, a line per fact."""
        if self.as_json:
            print(json.dumps(document, indent=2))
            return
        width = max(map(len, document), default=0)
        for name, value in document.items():
            print(f"{name:<{width}}  {_plain(value)}")

    def show_table(self, columns: Sequence[str], documents: Sequence[Document]) -> None:
        """Many, a row each with some of their facts."""
        if self.as_json:
            print(json.dumps(list(documents), indent=2))
            return
        rows = [list(columns), *([_plain(document[column]) for column in columns] for document in documents)]
        widths = [max(len(row[column]) for row in rows) for column in range(len(columns))]
        for row in rows:
            print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())

    def note(self, text: str) -> None:
        """Good to know; on stderr, so that stdout can be piped."""
        print(text, file=sys.stderr)


def moment(value: datetime | None) -> str | None:
    """As JSON has it: ISO 8601 in UTC, to the second."""
    return None if value is None else value.strftime("%Y-%m-%dT%H:%M:%SZ")


def _plain(value: object) -> str:
    if value is None:
        return "-"
    return ",".join(map(str, value)) if isinstance(value, list) else str(value)
