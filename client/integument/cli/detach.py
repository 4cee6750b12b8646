"""The command `detach`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from integument.cli.job_run import Wanted
from integument.cli.layer_text import CONTACT_FORM, read_contact_region
from integument.cli.mesh_argument import require_mesh
from integument.cli.options import ReportOption, SkinArgument, UnitOption
from integument.cli.process_command import add_process_command
from integument.cli.process_run import given, run_process


def register(app: typer.Typer) -> None:
    """Add the command."""
    add_process_command(app, detach)


def detach(
    ctx: typer.Context,
    skin: SkinArgument,
    region: Annotated[
        list[str],
        typer.Option(metavar="REGION", help=f"A box in mm around both parts and where they touch; repeat. {CONTACT_FORM}"),
    ],
    unit: UnitOption = "mm",
    gap: Annotated[float | None, typer.Option(metavar="MM", help="Smallest distance between the parts; default 1.")] = None,
    pieces: Annotated[int | None, typer.Option(metavar="N", help="Pieces wanted in the end; default 1.")] = None,
    narrowing: Annotated[
        float | None,
        typer.Option(metavar="SHARE", help="A contact is at most this share as deep as the thinner part; default 0.8."),
    ] = None,
    max_contact: Annotated[
        float | None, typer.Option(metavar="CM2", help="Largest contact that is opened; default 250 cm².")
    ] = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Where to put the skin, an STL.")] = None,
    report: ReportOption = None,
) -> None:
    """Set parts of a body apart where they touch: arms and torso, fingers, thighs."""
    inputs = given(
        regions=[read_contact_region(text) for text in region],
        gap_mm=gap,
        pieces=pieces,
        narrowing=narrowing,
        max_contact_cm2=max_contact,
    )
    require_mesh(skin)
    run_process(ctx, "detach", inputs, Wanted.of(report, skin=output), lambda sending: {"skin": sending.mesh(skin, unit)})
