"""The command `ears`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from integument.cli.app import options_of
from integument.cli.job_run import Wanted, run_to_end
from integument.cli.layer_inputs import read_layer_inputs
from integument.cli.layer_text import BOX_FORM, read_box
from integument.cli.mesh_argument import require_mesh
from integument.cli.mesh_reference import refer_to
from integument.cli.options import (
    BlendOption,
    CanalOption,
    ConductivityOption,
    EarDepthOption,
    GenerateCanalsOption,
    LayerOption,
    MinGapOption,
    OuterLayerOption,
    PackageOption,
    ReportOption,
    SkinArgument,
    SkinShiftOption,
    ThinPolicyOption,
    UnitOption,
)
from integument.cli.process_command import add_process_command
from integument.cli.session import connect
from integument.errors import ArgumentError

AUTO = "auto"


def register(app: typer.Typer) -> None:
    """Add the command."""
    add_process_command(app, ears)


def ears(
    ctx: typer.Context,
    skin: SkinArgument,
    unit: UnitOption = "mm",
    boxes: Annotated[
        list[str] | None,
        typer.Option("--ears", metavar="BOX", help=f"A box round an ear, {BOX_FORM} in mm; repeat. Default auto: find both."),
    ] = None,
    canal: CanalOption = None,
    generate_canals: GenerateCanalsOption = False,
    layer: LayerOption = None,
    outer_layer: OuterLayerOption = None,
    ear_depth: EarDepthOption = None,
    blend: BlendOption = None,
    thin_policy: ThinPolicyOption = "adapt",
    min_gap: MinGapOption = None,
    skin_shift: SkinShiftOption = None,
    conductivity: ConductivityOption = None,
    output: PackageOption = None,
    report: ReportOption = None,
) -> None:
    """Build nested shells that are thinner in the ears, and cut ear canals."""
    options = options_of(ctx)
    inputs = read_layer_inputs(
        layer=layer,
        outer_layer=outer_layer,
        ear_depth=ear_depth,
        blend=blend,
        thin_policy=thin_policy,
        min_gap=min_gap,
        skin_shift=skin_shift,
        conductivity=conductivity,
        generate_canals=generate_canals,
    )
    inputs["ears"] = read_ears(boxes or [AUTO])
    wanted = Wanted({} if output is None else {"package": output}, report)
    wanted.require_room()
    canals = [require_mesh(mesh) for mesh in canal or ()]
    require_mesh(skin)
    with connect(options) as session:
        view = options.progress_view()
        with view:
            inputs["skin"] = refer_to(session, view, skin, unit)
            if canals:
                inputs["canals"] = [refer_to(session, view, mesh, unit) for mesh in canals]
        raise typer.Exit(run_to_end(session, options, "ears", inputs, wanted))


def read_ears(texts: list[str]) -> str | list[dict[str, Any]]:
    """`auto`, or boxes as the server takes them. Raises: ArgumentError."""
    if texts == [AUTO]:
        return AUTO
    if AUTO in texts:
        raise ArgumentError("--ears: 'auto' finds both ears; it does not go with boxes")
    return [read_box(text, "--ears") for text in texts]
