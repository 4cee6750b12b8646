"""The command `graft`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from integument.cli.job_run import Wanted
from integument.cli.layer_text import BOX_FORM, read_box
from integument.cli.mesh_argument import require_mesh
from integument.cli.options import ReportOption, UnitOption
from integument.cli.process_command import add_process_command
from integument.cli.process_run import Sending, given, run_process


def register(app: typer.Typer) -> None:
    """Add the command."""
    add_process_command(app, graft)


def graft(
    ctx: typer.Context,
    base: Annotated[
        str, typer.Argument(help="Mesh file, or /v1/meshes/{id} or /v1/jobs/{id}/results/{output}: the one that stays.")
    ],
    donor: Annotated[str, typer.Argument(help="The one whose regions are set in; same unit as the base.")],
    region: Annotated[list[str], typer.Option(metavar="REGION", help=f"A box in mm; repeat. {BOX_FORM}")],
    unit: UnitOption = "mm",
    seam: Annotated[float | None, typer.Option(metavar="MM", help="Width of the strip that is triangulated anew.")] = None,
    max_distance: Annotated[
        float | None, typer.Option(metavar="MM", help="Largest distance between base and donor that is bridged.")
    ] = None,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Where to put the joined surface, an STL.")] = None,
    report: ReportOption = None,
) -> None:
    """Set regions of a donor into a base and join them to one closed surface."""
    inputs = given(regions=[read_box(text) for text in region], seam_mm=seam, max_distance_mm=max_distance)
    for mesh in (base, donor):
        require_mesh(mesh)

    def send(sending: Sending) -> dict[str, Any]:
        sent = sending.mesh(base, unit)
        return {"base": sent, "donor": sent if donor == base else sending.mesh(donor, unit)}

    run_process(ctx, "graft", inputs, Wanted.of(report, mesh=output), send)
