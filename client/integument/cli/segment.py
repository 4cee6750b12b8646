"""The command `segment`."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from integument.cli.job_run import Wanted
from integument.cli.layer_text import read_inside, read_label_names
from integument.cli.mesh_argument import require_mesh
from integument.cli.options import ConductivityOption, PackageOption, ReportOption
from integument.cli.process_command import add_process_command
from integument.cli.process_run import given, run_process
from integument.cli.tissue_text import read_conductivities


def register(app: typer.Typer) -> None:
    """Add the command."""
    add_process_command(app, segment, "--job-name")


def segment(
    ctx: typer.Context,
    volume: Annotated[
        str, typer.Argument(help="Label volume (.nii, .nii.gz, .mgz, .mgh), or /v1/meshes/{id} of one the server holds.")
    ],
    name: Annotated[
        list[str] | None,
        typer.Option(metavar="LABEL=NAME", help="Label and the name of its surface; repeat; labels of one name become one."),
    ] = None,
    others: Annotated[
        Literal["auto", "include", "ignore"] | None,
        typer.Option(help="Labels without a name; auto, the default, ignores them if there are names."),
    ] = None,
    islands: Annotated[
        Literal["keep_largest", "keep_above", "keep_all"] | None,
        typer.Option(help="Which pieces of a label stay; default keep_largest."),
    ] = None,
    min_island: Annotated[
        float | None, typer.Option(metavar="MM3", help="For keep_above: smallest volume of a piece; default 100.")
    ] = None,
    cavities: Annotated[
        Literal["fill", "keep"] | None,
        typer.Option(help="A surface is the outer border of its label (fill, default), or all of it."),
    ] = None,
    inside: Annotated[
        list[str] | None,
        typer.Option(metavar="INNER=OUTER", help="Draw the outer surface around the inner one, side by side or not; repeat."),
    ] = None,
    smoothing: Annotated[int | None, typer.Option(metavar="N", help="Steps of Taubin smoothing; default 10, 0 for none.")] = None,
    faces_share: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Share of the faces that stays; default 0.33.")
    ] = None,
    min_gap: Annotated[float | None, typer.Option(metavar="MM", help="Gap between every two surfaces; default 0.1.")] = None,
    conductivity: ConductivityOption = None,
    output: PackageOption = None,
    report: ReportOption = None,
) -> None:
    """Make closed surfaces of the labels of a volume, kept apart by a gap."""
    inputs = given(
        names=read_label_names(name or []) or None,
        others=others,
        islands=islands,
        min_island_mm3=min_island,
        cavities=cavities,
        inside=read_inside(inside or []) or None,
        smoothing=smoothing,
        faces_share=faces_share,
        min_gap_mm=min_gap,
        conductivities_s_per_m=read_conductivities(conductivity or []) or None,
    )
    require_mesh(volume)
    wanted = Wanted.of(report, package=output)
    run_process(ctx, "segment", inputs, wanted, lambda sending: {"volume": sending.mesh(volume, "mm")})
