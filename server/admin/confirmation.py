"""Nothing is destroyed by a slip: the operator says `--yes`, or is asked."""

from __future__ import annotations

import argparse
import sys

from core.errors import InputError


def add_yes(command: argparse.ArgumentParser) -> None:
    """The option."""
    command.add_argument("--yes", action="store_true", help="do not ask")


def require_yes(options: argparse.Namespace, what: str) -> None:
    """Returns if `what` is to be done. Raises InputError `admin.not_confirmed`; where nobody can be asked, too."""
    if options.yes:
        return
    if not sys.stdin.isatty():
        raise InputError("admin.not_confirmed", f"{what}: say --yes")
    print(f"{what}? [y/N] ", end="", file=sys.stderr, flush=True)
    if sys.stdin.readline().strip().lower() not in ("y", "yes"):
        raise InputError("admin.not_confirmed", "nothing was done")
