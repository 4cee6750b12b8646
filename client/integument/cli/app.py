"""The command line's frame: global options. The commands register themselves in `integument.cli.main`."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer

from integument.cli.screen import Screen
from integument.cli.session import Options

HELP = """Nested shells and proven meshes from an Integument server.

--server, --key-file, --json and --quiet may stand anywhere. Without a server a private one is started for the call.
Exit codes: 0 done and ready; 1 done but not ready, or failed; 2 bad usage or input; 3 no server.
"""

app = typer.Typer(
    name="integument",
    help=HELP,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"integument {version('integument')}")
        raise typer.Exit


@app.callback()
def _frame(
    ctx: typer.Context,
    server: Annotated[
        str | None, typer.Option(envvar="INTEGUMENT_URL", metavar="URL", help="Address of a running server.")
    ] = None,
    key_file: Annotated[
        Path | None,
        typer.Option("--key-file", dir_okay=False, help="File with the API key; without it INTEGUMENT_API_KEY."),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="One JSON document on stdout; progress as JSON lines on stderr.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress and no notes.")] = False,
    _version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    ctx.obj = Options(server=server, screen=Screen(as_json=as_json, quiet=quiet), key_file=key_file)


def options_of(ctx: typer.Context) -> Options:
    """The global options of this call."""
    options: Options = ctx.obj
    return options
