"""`integument admin gc`: remove at once what the service removes by and by."""

from __future__ import annotations

from argparse import Namespace
from typing import TYPE_CHECKING

from core.errors import InputError
from server.admin.arguments import Subparsers
from server.admin.confirmation import add_yes, require_yes
from server.admin.desk import Desk
from store.open_blobs import open_blobs
from store.sqlite_file import SqliteFile
from store.workspace import DEFAULT_WORKSPACE

if TYPE_CHECKING:
    from server.garbage import Heap

COLUMNS = ("kind", "count", "bytes")


def register(groups: Subparsers) -> None:
    """Add the command."""
    collect = groups.add_parser("gc", help="remove files, folders and rows nobody needs; the service may run")
    collect.add_argument("--dry-run", action="store_true", help="only say what there is")
    collect.add_argument(
        "--rewrite", action="store_true", help="then write a SQLite file anew, as small as it can be; the service waits meanwhile"
    )
    add_yes(collect)
    collect.set_defaults(run=_collect)


def _collect(desk: Desk, options: Namespace) -> None:
    from server.garbage import Garbage, Heap  # loads API and worker, which other commands need not wait for

    garbage = Garbage(desk.settings, desk.db, open_blobs(desk.settings, desk.db))
    if options.rewrite and not desk.db.is_sqlite:
        raise InputError("admin.nothing_selected", "--rewrite is for SQLite; PostgreSQL has VACUUM FULL")
    if options.dry_run:
        return _show(desk, garbage.find())
    require_yes(options, "remove what `gc --dry-run` shows")
    heaps = garbage.remove()
    if options.rewrite:
        heaps = (*heaps, Heap("shrunk by rewriting", 1, SqliteFile(desk.db).rewrite()))
    desk.note_act("gc", f"{sum(heap.count for heap in heaps)} things", DEFAULT_WORKSPACE)
    return _show(desk, heaps)


def _show(desk: Desk, heaps: tuple[Heap, ...]) -> None:
    desk.show_table(COLUMNS, [{"kind": heap.kind, "count": heap.count, "bytes": heap.bytes} for heap in heaps])
