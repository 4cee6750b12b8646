"""The commands as one call: words in, exit code out."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from pydantic import ValidationError

from core.errors import InputError, IntegumentError, StateError
from server.admin import audit, backup, doctor, gc, jobs, keys, parked, retention, workspaces
from server.admin.desk import Desk
from store.database import Database
from store.settings import Settings

GROUPS: tuple[ModuleType, ...] = (keys, workspaces, jobs, parked, audit, retention, gc, backup, doctor)
"""Each has `register(groups)`, which adds its commands; `run(desk, options)` is what one does, and may return the exit code."""

DESCRIPTION = """\
What only whoever runs the server may do. It works on the database the settings of the server name (INTEGUMENT_DATA_DIR or
INTEGUMENT_DATABASE_URL), so run it where the server runs, as its user; the server may run meanwhile.
"""


def admin(arguments: Sequence[str] | None = None) -> int:
    """Run one command. Exit codes: 0 done, 1 something failed or was found wrong, 2 bad usage or the request was at fault."""
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as end:  # argparse has said why
        return int(end.code or 0)
    try:
        settings = Settings() if options.data_dir is None else Settings(data_dir=options.data_dir)
    except ValidationError as error:  # its text names the setting and hides the value
        print(f"integument admin: {error}", file=sys.stderr)
        return 2
    database = Database(settings)
    try:
        database.migrate()  # the first key is often made before the first start
        code: int | None = options.run(Desk(settings, database, options.as_json), options)
    except IntegumentError as error:
        print(f"integument admin: {error.message} [{error.code}]", file=sys.stderr)
        return 2 if isinstance(error, InputError | StateError) else 1
    finally:
        database.close()
    return code or 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="integument admin", description=DESCRIPTION)
    parser.add_argument("--json", action="store_true", dest="as_json", help="one JSON document on stdout")
    parser.add_argument("--data-dir", type=Path, default=None, help="folder of the embedded server, if not that of the settings")
    groups = parser.add_subparsers(metavar="GROUP", required=True)
    for group in GROUPS:
        group.register(groups)
    return parser
