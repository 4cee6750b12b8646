"""`integument serve`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from integument.data_folder import default_data_dir
from integument.server_entry import run_server


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(serve)


def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port to listen on; 0 takes a free one.")] = 8000,
    data_dir: Annotated[
        Path | None,
        typer.Option(
            file_okay=False, help="Folder of everything it keeps; default INTEGUMENT_DATA_DIR or ~/.local/share/integument."
        ),
    ] = None,
    while_used: Annotated[bool, typer.Option(hidden=True)] = False,
) -> None:
    """Run the embedded server until Ctrl-C: API, worker and queue in one data folder."""
    folder = (data_dir or default_data_dir()).absolute()
    folder.mkdir(parents=True, exist_ok=True, mode=0o700)
    raise typer.Exit(run_server(data_dir=folder, host=host, port=port, while_used=while_used))
