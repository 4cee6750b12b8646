"""`integument admin backup`, `backups`, `restore`: everything copied while the service runs, and brought back."""

from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from api.version import SERVER_VERSION
from core.errors import InputError
from server.admin.arguments import Subparsers, whole_number
from server.admin.confirmation import add_yes, require_yes
from server.admin.desk import Desk, moment
from server.data_folder import DataFolder
from store.backup.make import Backup, verify
from store.backup.manifest import Manifest
from store.backup.restore import Restore
from store.backup.vault import Vault
from store.open_blobs import open_blobs
from store.workspace import DEFAULT_WORKSPACE

COLUMNS = ("name", "created", "version", "rows", "files", "bytes", "missing", "corrupt", "whole")


def register(groups: Subparsers) -> None:
    """Add the commands."""
    backup = groups.add_parser("backup", help="copy rows and files into a folder, while the service runs")
    backup.add_argument(
        "target", metavar="FOLDER", type=Path, help="keeps any number of backups; what one holds is not copied again"
    )
    backup.add_argument("--keep", type=_at_least_one, default=None, metavar="N", help="then remove all but the newest N")
    backup.set_defaults(run=_backup)

    listing = groups.add_parser("backups", help="list the backups of a folder")
    listing.add_argument("target", metavar="FOLDER", type=Path)
    listing.add_argument("--verify", action="store_true", help="read every byte of them; exit code 1 if one is not whole")
    listing.set_defaults(run=_list)

    restore = groups.add_parser("restore", help="bring a backup back into an empty place; nothing may run there")
    restore.add_argument("source", metavar="FOLDER", type=Path)
    restore.add_argument("--name", default=None, help="which one [the newest]")
    restore.add_argument(
        "--files-only",
        action="store_true",
        help="put back files that are missing or corrupt, and touch no row; the service may run",
    )
    add_yes(restore)
    restore.set_defaults(run=_restore)


def _backup(desk: Desk, options: Namespace) -> int:
    vault = Vault(options.target)
    report = Backup(desk.db, open_blobs(desk.settings, desk.db), vault, SERVER_VERSION).make()
    gone: list[str] = []
    if options.keep is not None:
        with vault.alone():
            gone = list(vault.keep(options.keep))
    desk.note_act("backup", report.name, DEFAULT_WORKSPACE)
    manifest = report.manifest
    desk.show({**_line(report.name, manifest), "copied": report.copied, "copied_bytes": report.copied_bytes, "removed": gone})
    for said, lost in (("are not in the store", manifest.missing), ("are not what they are called", manifest.corrupt)):
        if lost:
            desk.note(f"{len(lost)} files that rows name {said}, so this backup lacks them: {', '.join(lost[:3])} ...")
    return 1 if manifest.missing or manifest.corrupt else 0


def _list(desk: Desk, options: Namespace) -> int:
    vault = _existing(options.target)
    lines, all_whole = [], True
    for name in vault.names():
        whole = verify(vault, name, desk.note) if options.verify else None
        all_whole = all_whole and whole is not False
        lines.append({**_line(name, vault.manifest(name)), "whole": whole})
    desk.show_table(COLUMNS, lines)
    return 0 if all_whole else 1


def _restore(desk: Desk, options: Namespace) -> None:
    vault = _existing(options.source)
    names = vault.names()
    if not names:
        raise InputError("backup.not_found", f"there is no whole backup in {vault.folder}")
    name = options.name or names[0]
    restore = Restore(desk.db, open_blobs(desk.settings, desk.db), vault)
    if options.files_only:
        put = restore.put_files(vault.blob_names(name))
        desk.note_act("restore files", name, DEFAULT_WORKSPACE)
        desk.show({"name": name, "files_put": put})
        return
    manifest = vault.manifest(name)
    require_yes(
        options, f"restore {manifest.rows} rows and {manifest.blobs.count} files of {manifest.created_at:%Y-%m-%d %H:%M} UTC"
    )
    with ExitStack() as held:
        if desk.db.is_sqlite:  # an embedded server must not start before this has ended
            held.callback(DataFolder(desk.settings.data_dir).release)
        report = restore.restore(name)
    desk.note_act("restore", name, DEFAULT_WORKSPACE)
    desk.show({**_line(name, report.manifest), "files_put": report.blobs, "jobs_queued_again": report.queued_again})


def _line(name: str, manifest: Manifest) -> dict[str, Any]:
    return {
        "name": name,
        "created": moment(manifest.created_at),
        "version": manifest.version,
        "revision": manifest.revision,
        "rows": manifest.rows,
        "files": manifest.blobs.count,
        "bytes": manifest.blobs.bytes,
        "missing": len(manifest.missing),
        "corrupt": len(manifest.corrupt),
    }


def _existing(folder: Path) -> Vault:
    if not folder.is_dir():
        raise InputError("backup.not_found", f"there is no folder {folder}")
    return Vault(folder)


def _at_least_one(text: str) -> int:
    number = whole_number(text)
    if number < 1:
        raise ArgumentTypeError("at least 1")
    return number
