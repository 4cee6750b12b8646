"""The command `fields`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from integument.cli.column_words import split_columns
from integument.cli.job_run import Wanted
from integument.cli.mesh_argument import require_mesh
from integument.cli.options import ReportOption, UnitOption
from integument.cli.placement_file import read_placement
from integument.cli.process_command import add_process_command
from integument.cli.process_run import Sending, given, run_process
from integument.cli.surfaces_argument import read_surfaces
from integument.errors import ArgumentError
from integument.surface_processes import Unit


def register(app: typer.Typer) -> None:
    """Add the command."""
    add_process_command(app, fields)


def fields(
    ctx: typer.Context,
    files: Annotated[
        list[str],
        typer.Argument(
            help="Surfaces as for `heal` (mesh files, links, or a package), and last the field: .msh, .csv or .txt, or the "
            "/v1/meshes/{id} of one the server holds."
        ),
    ],
    unit: UnitOption = "mm",
    field_length_unit: Annotated[
        Unit | None, typer.Option("--field-length-unit", help="Unit of the places in the field file; default that of --unit.")
    ] = None,
    columns: Annotated[
        str | None,
        typer.Option(metavar="NAMES", help="Columns of a text file from left to right, as x y z Ex Ey Ez; `-` for one not used."),
    ] = None,
    data: Annotated[str | None, typer.Option(metavar="NAME", help="Data of a gmsh file; default E.")] = None,
    field_unit: Annotated[
        Literal["V/m", "mV/mm", "V/mm", "V/cm", "mV/m"] | None, typer.Option(help="Unit of the field; default V/m.")
    ] = None,
    method: Annotated[
        Literal["auto", "nearest", "inverse_distance", "containing"] | None,
        typer.Option(help="How a triangle gets its value; default auto."),
    ] = None,
    neighbours: Annotated[int | None, typer.Option(metavar="N", help="Points for inverse_distance; default 8.")] = None,
    max_distance: Annotated[
        float | None, typer.Option(metavar="MM", help="A triangle farther from the field gets no value; default 5.")
    ] = None,
    inward: Annotated[
        float | None, typer.Option(metavar="MM", help="How far below the triangles the field is taken; default 0.")
    ] = None,
    leave_out_nan: Annotated[
        bool, typer.Option("--leave-out-nan", help="Leave rows with NaN out and count them; else the file is refused.")
    ] = False,
    only: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="A surface of the package that gets the field; repeat; default all.")
    ] = None,
    coil: Annotated[
        str | None, typer.Option(metavar="FILE", help="A coil (.ccd, .tcd) to be drawn beside the surfaces, or its link.")
    ] = None,
    placement: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Text file with the 4 x 4 matrix of the coil, in mm; default: as it is.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Where to put all files, a zip; or the surfaces alone, if it ends in .msh or .csv."),
    ] = None,
    report: ReportOption = None,
) -> None:
    """Bring the field of a solver onto surfaces: a value per triangle, numbers, pictures, files; the coil beside it."""
    surfaces, field = _read_files(files)
    if coil is not None:
        require_mesh(coil)
    elif placement is not None:
        raise ArgumentError("--placement says where the coil stands: name it with --coil")
    matrix = None if placement is None else read_placement(placement)
    inputs = given(
        columns=None if columns is None else split_columns(columns),
        data=data,
        field_unit=field_unit,
        method=method,
        neighbours=neighbours,
        max_distance_mm=max_distance,
        inward_mm=inward,
        not_finite="leave_out" if leave_out_nan else None,
        only=only or None,
    )

    def send(sending: Sending) -> dict[str, Any]:
        sent = sending.surfaces(surfaces, unit) | {"field": sending.mesh(field, field_length_unit or unit)}
        if coil is not None:
            sent["coil"] = given(file=sending.mesh(coil, "mm"), placement=matrix)
        return sent

    run_process(ctx, "fields", inputs, Wanted.of(report, **_wanted_of(output)), send)


def _read_files(files: Sequence[str]) -> tuple[Any, str]:
    if len(files) < 2:
        raise ArgumentError("name one surface or more, and last the field: integument fields skin.stl field.csv")
    return read_surfaces(list(files[:-1])), require_mesh(files[-1])


def _wanted_of(path: Path | None) -> dict[str, Path]:
    return {} if path is None else {{".msh": "msh", ".csv": "statistics"}.get(path.suffix.lower(), "fields"): path}
