"""The command `prepare`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from integument.cli.ears import read_ears
from integument.cli.job_run import Wanted
from integument.cli.layer_inputs import read_layer_inputs
from integument.cli.layer_text import BOX_FORM, read_box, read_volumes
from integument.cli.mesh_argument import require_mesh
from integument.cli.options import (
    BlendOption,
    CanalOption,
    ConductivityOption,
    EarDepthOption,
    GenerateCanalsOption,
    LayerOption,
    MesherOption,
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
from integument.cli.tissue_text import read_pairs
from integument.errors import ArgumentError

TISSUE_FORM = "NAME=MESH"


def register(app: typer.Typer) -> None:
    """Add the command."""
    add_process_command(app, prepare)


def prepare(
    ctx: typer.Context,
    skin: SkinArgument,
    unit: UnitOption = "mm",
    heal: Annotated[bool, typer.Option("--heal/--no-heal", help="Mend the skin first, or refuse an unfit one.")] = True,
    ratio: Annotated[
        float | None, typer.Option("--decimate", metavar="SHARE", help="Thin the skin out to this share of its faces.")
    ] = None,
    faces: Annotated[int | None, typer.Option(metavar="N", help="Thin the skin out to at most so many faces.")] = None,
    detach: Annotated[
        list[str] | None,
        typer.Option(metavar="BOX", help=f"Box round parts that are grown together where they touch, {BOX_FORM} in mm; repeat."),
    ] = None,
    smooth: Annotated[
        bool, typer.Option("--smooth", help="Smooth the skin for better triangles, no vertex farther than 0.5 mm.")
    ] = False,
    boxes: Annotated[
        list[str] | None, typer.Option("--ears", metavar="BOX", help=f"auto: find both ears; or a box, {BOX_FORM} in mm; repeat.")
    ] = None,
    canal: CanalOption = None,
    generate_canals: GenerateCanalsOption = False,
    layer: LayerOption = None,
    outer_layer: OuterLayerOption = None,
    ear_depth: EarDepthOption = None,
    blend: BlendOption = None,
    region: RegionOption = None,
    tissue: Annotated[
        list[str] | None,
        typer.Option(metavar=TISSUE_FORM, help="Closed surface inside the innermost layer, an organ or a bone; repeat."),
    ] = None,
    inside: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=NAME", help="Tissue and the one that must be next around it, or the job is refused; repeat."),
    ] = None,
    conductivity: ConductivityOption = None,
    separate: Annotated[
        bool, typer.Option("--separate/--no-separate", help="Move tissues that touch or cross apart, or refuse them.")
    ] = True,
    tissue_gap: Annotated[
        float | None, typer.Option(metavar="MM", help="Gap to open between tissues that touch or cross; default 0.1.")
    ] = None,
    thin_policy: ThinPolicyOption = "adapt",
    min_gap: MinGapOption = None,
    skin_shift: SkinShiftOption = None,
    tetrahedra: Annotated[
        bool, typer.Option("--tetrahedra/--no-tetrahedra", help="Fill all tissues with tetrahedra, or stop at surfaces.")
    ] = True,
    mesher: MesherOption = None,
    radius_edge: Annotated[
        float | None,
        typer.Option(metavar="RATIO", help="Largest ratio of circumradius to shortest edge, 1.1 to 10; default 2, 0 for none."),
    ] = None,
    max_volume: Annotated[
        list[str] | None, typer.Option(metavar="NAME=MM3", help="Largest tetrahedron of a tissue, in mm³; repeat.")
    ] = None,
    output: PackageOption = None,
    volume: Annotated[
        Path | None,
        typer.Option("--volume", help="Where to put the tetrahedra: gmsh 2.2 for SimNIBS, or VTU if it ends in .vtu."),
    ] = None,
    record: Annotated[
        Path | None, typer.Option("--steps", help="Where to put the record of the steps: outcome, numbers, seconds; JSON.")
    ] = None,
    report: ReportOption = None,
) -> None:
    """Prepare a model: heal, decimate, detach, smooth, ears, layers, tissues, proof, tetrahedra, package; in one job."""
    if not tetrahedra and (mesher or radius_edge is not None or max_volume or volume is not None):
        raise ArgumentError(
            "--mesher, --radius-edge, --max-volume and --volume are about tetrahedra; they do not go with --no-tetrahedra"
        )
    if ratio is not None and faces is not None:
        raise ArgumentError("--decimate and --faces both say how far to thin out; give one")
    if not separate and tissue_gap is not None:
        raise ArgumentError("--tissue-gap does not go with --no-separate")
    inputs = read_layer_inputs(
        layer=layer,
        outer_layer=outer_layer,
        region=region,
        ear_depth=ear_depth,
        blend=blend,
        thin_policy=thin_policy,
        min_gap=min_gap,
        skin_shift=skin_shift,
        conductivity=conductivity,
        generate_canals=generate_canals,
    )
    inputs |= {name: None for name, asked in (("heal", heal), ("separate", separate), ("tetrahedra", tetrahedra)) if not asked}
    if detach:
        inputs["detach"] = {"regions": [read_box(text, "--detach") for text in detach]}
    if smooth:
        inputs["smooth"] = {}
    if tissue_gap is not None:
        inputs["separate"] = {"gap_mm": tissue_gap}
    if ratio is not None or faces is not None:
        inputs["decimate"] = {"target_ratio": ratio} if faces is None else {"target_faces": faces}
    if boxes:
        inputs["ears"] = read_ears(boxes)
    if asked := _tetrahedra(mesher, radius_edge, max_volume or []):
        inputs["tetrahedra"] = asked
    files = {"package": output, "vtu" if volume and volume.suffix == ".vtu" else "msh": volume, "steps": record}
    canals = [require_mesh(mesh) for mesh in canal or ()]
    tissues = {name: require_mesh(mesh) for name, mesh in read_pairs(tissue or (), "--tissue", TISSUE_FORM).items()}
    about = _about_tissues(tissues, inside or [])
    require_mesh(skin)

    def send(sending: Sending) -> dict[str, Any]:
        return given(
            skin=sending.mesh(skin, unit),
            canals=[sending.mesh(mesh, unit) for mesh in canals] or None,
            tissues=[{"name": name, "mesh": sending.mesh(mesh, unit), **about[name]} for name, mesh in tissues.items()] or None,
        )

    run_process(ctx, "prepare", inputs, Wanted.of(report, **files), send)


def _tetrahedra(mesher: str | None, radius_edge: float | None, max_volume: list[str]) -> dict[str, Any]:
    asked = given(mesher=mesher, max_volume_mm3=read_volumes(max_volume) or None)
    return asked if radius_edge is None else asked | {"radius_edge": radius_edge or None}


def _about_tissues(tissues: dict[str, str], inside: list[str]) -> dict[str, dict[str, Any]]:
    """Tissue -> what was said of it. Raises: ArgumentError about a name that is no --tissue."""
    about: dict[str, dict[str, Any]] = {name: {} for name in tissues}
    for name, around in read_pairs(inside, "--inside", "NAME=NAME").items():
        if name not in about:
            raise ArgumentError(f"--inside {name}: there is no --tissue {name}")
        about[name]["inside"] = around
    return about
