"""The entry point: argument list in, exit code out."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from integument.cli import (
    admin,
    catalogue,
    cohorts,
    detach,
    ears,
    execute,
    fields,
    graft,
    jobs,
    labels,
    prepare,
    segment,
    serve,
    surface_commands,
)
from integument.cli.app import app
from integument.cli.column_words import join_columns
from integument.cli.exit_code import ExitCode, exit_code_of
from integument.cli.global_options import split_global
from integument.cli.screen import Screen
from integument.errors import IntegumentError

for part in (
    serve,
    admin,
    execute,
    ears,
    prepare,
    graft,
    detach,
    segment,
    fields,
    surface_commands,
    cohorts,
    jobs,
    labels,
    catalogue,
):
    part.register(app)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; `arguments` default to the process' own. Never raises what a user can cause."""
    found, rest = split_global(sys.argv[1:] if arguments is None else arguments)
    rest = join_columns(rest)
    try:
        app(args=[*found, *rest], prog_name="integument")
    except SystemExit as end:
        return int(end.code or 0)
    except IntegumentError as error:
        code = exit_code_of(error)
        Screen(as_json="--json" in found).failure(error, code)
        return code
    except OSError as error:
        Screen(as_json="--json" in found).failure(IntegumentError(str(error)), ExitCode.NOT_READY)
        return ExitCode.NOT_READY
    return 0
