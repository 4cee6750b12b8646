"""What the server can do and what it holds: `processes`, `meshes`."""

from __future__ import annotations

from typing import Annotated

import typer
from rich import box
from rich.table import Table

from integument.cli.app import options_of
from integument.cli.session import connect


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command()(processes)
    app.command()(meshes)


def processes(
    ctx: typer.Context,
    process: Annotated[str | None, typer.Argument(metavar="[ID]", help="Show this one with its inputs.")] = None,
) -> None:
    """List the server's processes, or the inputs of one."""
    options = options_of(ctx)
    with connect(options) as session:
        found = session.client.processes() if process is None else [session.client.process(process)]
    options.screen.document([item.as_json() for item in found] if process is None else found[0].as_json())
    table = Table(box=box.SIMPLE_HEAD)
    for title in ("process", "version", "title") if process is None else ("input", "title", "description"):
        table.add_column(title)
    for item in found:
        if process is None:
            table.add_row(item.id, item.version, item.title)
        for name, description in item.inputs.items():
            table.add_row(name, str(description.get("title", "")), str(description.get("description", "")))
    options.screen.show(table)


def meshes(
    ctx: typer.Context,
    limit: Annotated[int, typer.Option(min=1, help="At most so many, the newest first.")] = 20,
) -> None:
    """List uploaded meshes."""
    options = options_of(ctx)
    with connect(options) as session:
        found = list(session.client.meshes(limit=limit))
    options.screen.document([item.as_json() for item in found])
    table = Table(box=box.SIMPLE_HEAD)
    for title in ("mesh", "name", "file", "faces", "extents mm", "arrays"):
        table.add_column(title)
    for mesh in found:
        extents = " × ".join(f"{length:.1f}" for length in mesh.extents_mm or ())
        table.add_row(
            mesh.id, mesh.name, mesh.file_name, f"{mesh.faces or 0:,}", extents, ", ".join(each.name for each in mesh.arrays)
        )
    options.screen.show(table)
