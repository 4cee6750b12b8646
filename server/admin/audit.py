"""`integument admin audit`."""

from __future__ import annotations

import json
from argparse import Namespace
from datetime import UTC, datetime

from server.admin.arguments import Subparsers, positive_days, whole_number
from server.admin.desk import Desk
from store.audit import Audit
from store.workspace import WorkspaceId

COLUMNS = ("at", "workspace", "actor", "key", "action", "subject", "outcome")


def register(groups: Subparsers) -> None:
    """Add the command."""
    audit = groups.add_parser("audit", help="who did what, the newest first; with --json a line each")
    audit.add_argument("--workspace", default=None, help="of this one only")
    audit.add_argument("--days", type=positive_days, default=None, help="not older than so many days")
    audit.add_argument("--limit", type=whole_number, default=100, help="at most so many [%(default)s]")
    audit.set_defaults(run=_show)


def _show(desk: Desk, options: Namespace) -> None:
    entries = Audit(desk.db).list(
        workspace=None if options.workspace is None else WorkspaceId(options.workspace),
        since=None if options.days is None else datetime.now(UTC) - options.days,
        limit=options.limit,
    )
    documents = [entry.describe() for entry in entries]
    if desk.as_json:
        for document in documents:
            print(json.dumps(document))
    else:
        desk.show_table(COLUMNS, documents)
