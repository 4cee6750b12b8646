"""The command `graft`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from integument.cli.app import options_of
from integument.cli.job_run import Wanted, run_to_end
from integument.cli.layer_text import BOX_FORM, read_box
from integument.cli.mesh_argument import require_mesh
from integument.cli.mesh_reference import refer_to
from integument.cli.options import ReportOption, UnitOption
from integument.cli.process_command import add_process_command
from integument.cli.session import connect


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
    options = options_of(ctx)
    inputs: dict[str, Any] = {"regions": [read_box(text) for text in region]}
    if seam is not None:
        inputs["seam_mm"] = seam
    if max_distance is not None:
        inputs["max_distance_mm"] = max_distance
    wanted = Wanted({} if output is None else {"mesh": output}, report)
    wanted.require_room()
    for mesh in (base, donor):
        require_mesh(mesh)
    with connect(options) as session:
        view = options.progress_view()
        with view:
            inputs["base"] = refer_to(session, view, base, unit)
            inputs["donor"] = inputs["base"] if donor == base else refer_to(session, view, donor, unit)
        raise typer.Exit(run_to_end(session, options, "graft", inputs, wanted))
