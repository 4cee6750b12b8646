"""`integument admin`: handed on to the server installed beside this client, word by word."""

from __future__ import annotations

import typer

from integument.cli.app import options_of
from integument.server_entry import run_admin

AS_THEY_ARE = {"ignore_unknown_options": True, "allow_extra_args": True, "help_option_names": []}


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(context_settings=AS_THEY_ARE, add_help_option=False)(admin)


def admin(ctx: typer.Context) -> None:
    """Run the server: keys, workspaces, jobs, retention, backups, doctor; `integument admin --help`."""
    words = (["--json"] if options_of(ctx).screen.as_json else []) + ctx.args
    raise typer.Exit(run_admin(words))
