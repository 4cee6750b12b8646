"""The command `ears`."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from integument.cli.job_run import Wanted
from integument.cli.layer_inputs import read_layer_inputs
from integument.cli.layer_text import BOX_FORM, read_box
from integument.cli.mesh_argument import require_mesh
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
from integument.cli.process_run import Sending, given, run_process
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
    canals = [require_mesh(mesh) for mesh in canal or ()]
    require_mesh(skin)

    def send(sending: Sending) -> dict[str, Any]:
        return given(skin=sending.mesh(skin, unit), canals=[sending.mesh(mesh, unit) for mesh in canals] or None)

    run_process(ctx, "ears", inputs, Wanted.of(report, package=output), send)


def read_ears(texts: list[str]) -> str | list[dict[str, Any]]:
    """`auto`, or boxes as the server takes them. Raises: ArgumentError."""
    if texts == [AUTO]:
        return AUTO
    if AUTO in texts:
        raise ArgumentError("--ears: 'auto' finds both ears; it does not go with boxes")
    return [read_box(text, "--ears") for text in texts]
