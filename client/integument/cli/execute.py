"""The commands that run a process: `shells`, `validate`, `run`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from integument.cli.job_run import Wanted
from integument.cli.layer_inputs import read_layer_inputs
from integument.cli.mesh_argument import name_meshes, require_mesh
from integument.cli.options import (
    ConductivityOption,
    LayerOption,
    MinGapOption,
    OuterLayerOption,
    PackageOption,
    RegionOption,
    ReportOption,
    SkinArgument,
    SkinShiftOption,
    ThinPolicyOption,
    UnitOption,
)
from integument.cli.process_command import add_process_command
from integument.cli.process_run import Sending, given, run_process
from integument.errors import ArgumentError


def register(app: typer.Typer) -> None:
    """Add the commands."""
    add_process_command(app, shells)
    add_process_command(app, validate)
    add_process_command(app, run)


def shells(
    ctx: typer.Context,
    skin: SkinArgument,
    unit: UnitOption = "mm",
    layer: LayerOption = None,
    outer_layer: OuterLayerOption = None,
    region: RegionOption = None,
    thin_policy: ThinPolicyOption = "adapt",
    min_gap: MinGapOption = None,
    skin_shift: SkinShiftOption = None,
    conductivity: ConductivityOption = None,
    output: PackageOption = None,
    report: ReportOption = None,
) -> None:
    """Build nested shells inside a skin, proven free of intersections."""
    inputs = read_layer_inputs(
        layer=layer,
        outer_layer=outer_layer,
        region=region,
        thin_policy=thin_policy,
        min_gap=min_gap,
        skin_shift=skin_shift,
        conductivity=conductivity,
    )
    require_mesh(skin)
    run_process(ctx, "shells", inputs, Wanted.of(report, package=output), lambda sending: {"skin": sending.mesh(skin, unit)})


def validate(
    ctx: typer.Context,
    meshes: Annotated[
        list[str], typer.Argument(help="Mesh files or /v1/meshes/{id}; several are also checked against each other.")
    ],
    unit: UnitOption = "mm",
    min_gap: Annotated[float | None, typer.Option(metavar="MM", help="Meshes closer than this are an error.")] = None,
    report: ReportOption = None,
) -> None:
    """Check meshes: closed, manifold, outward, free of intersections, nested, apart."""
    named = name_meshes([require_mesh(mesh) for mesh in meshes])

    def send(sending: Sending) -> dict[str, Any]:
        return {"meshes": {name: sending.mesh(mesh, unit) for name, mesh in named.items()}}

    run_process(ctx, "validate", given(min_gap_mm=min_gap), Wanted.of(report), send)


def run(
    ctx: typer.Context,
    process: Annotated[str, typer.Argument(help="Process id, see `integument processes`.")],
    inputs: Annotated[Path, typer.Option(help="JSON file with the inputs; - reads them from stdin.")],
    output: Annotated[
        list[str] | None, typer.Option("--output", "-o", metavar="NAME=FILE", help="Output to fetch and where to; repeat.")
    ] = None,
    report: ReportOption = None,
) -> None:
    """Run any process with inputs from a JSON file."""
    wanted = Wanted(dict(_read_output(text) for text in output or ()), report)
    run_process(ctx, process, read_inputs(inputs), wanted, lambda _sending: {})


def _read_output(text: str) -> tuple[str, Path]:
    name, sign, path = text.partition("=")
    if not (name and sign and path):
        raise ArgumentError(f"--output {text}: wanted is name=file, as package=package.zip")
    return name, Path(path)


def read_inputs(path: Path) -> dict[str, Any]:
    """The inputs object itself, or a whole execute request that holds it. Raises: ArgumentError."""
    try:
        text = sys.stdin.read() if str(path) == "-" else path.read_text(encoding="utf-8")
        document = json.loads(text)
    except OSError as error:
        raise ArgumentError(f"cannot read {path}: {error.strerror or error}") from error
    except ValueError as error:
        raise ArgumentError(f"{path} is no JSON: {error}") from error
    inputs = document.get("inputs", document) if isinstance(document, dict) else document
    if not isinstance(inputs, dict):
        raise ArgumentError(f"{path} holds no JSON object with the inputs")
    return inputs
