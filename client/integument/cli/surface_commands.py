"""The commands that take surfaces: `heal`, `decimate`, `smooth`, `separate`, `tetrahedralize`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from integument.cli.job_run import Wanted
from integument.cli.layer_text import (
    BOX_FORM,
    RATIO_FORM,
    read_box,
    read_inside,
    read_priorities,
    read_ratio_region,
    read_volumes,
)
from integument.cli.options import (
    ConductivityOption,
    MesherOption,
    MinGapOption,
    PackageOption,
    ReportOption,
    SurfaceOption,
    SurfacesArgument,
    UnitOption,
    VolumeOption,
)
from integument.cli.process_command import add_process_command
from integument.cli.process_run import given, run_process
from integument.cli.surfaces_argument import read_surfaces
from integument.cli.tissue_text import read_conductivities
from integument.errors import ArgumentError
from integument.surface_processes import Unit


def register(app: typer.Typer) -> None:
    """Add the commands."""
    add_process_command(app, heal)
    add_process_command(app, decimate)
    add_process_command(app, smooth)
    add_process_command(app, separate)
    add_process_command(app, tetrahedralize)


def heal(
    ctx: typer.Context,
    surfaces: SurfacesArgument,
    unit: UnitOption = "mm",
    pieces: Annotated[
        Literal["keep_largest", "keep_above", "keep_all"] | None,
        typer.Option(help="Which pieces stay; default keep_largest."),
    ] = None,
    min_piece_share: Annotated[
        float | None, typer.Option(metavar="SHARE", help="For keep_above: smallest area, as share of the largest piece's.")
    ] = None,
    fill_holes: Annotated[bool, typer.Option("--fill-holes/--no-fill-holes", help="Fill holes, or refuse them.")] = True,
    max_hole: Annotated[float | None, typer.Option(metavar="MM", help="Longest rim of a hole that is filled.")] = None,
    weld_tolerance: Annotated[float | None, typer.Option(metavar="MM", help="Borders this near each other are joined.")] = None,
    staircase: Annotated[bool, typer.Option("--staircase", help="Smooth the steps of a surface made from voxels.")] = False,
    max_deviation: Annotated[
        float | None, typer.Option(metavar="MM", help="Refuse to move the surface farther; default 5.")
    ] = None,
    max_volume_change: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Refuse to change the volume more; default 0.05.")
    ] = None,
    max_area_change: Annotated[
        float | None, typer.Option(metavar="SHARE", help="Refuse to change the area more; default 0.25.")
    ] = None,
    min_gap: MinGapOption = None,
    conductivity: ConductivityOption = None,
    output: SurfaceOption = None,
    report: ReportOption = None,
) -> None:
    """Make defective surfaces closed, manifold and free of self-intersection, with the smallest change."""
    inputs = given(
        conductivities_s_per_m=read_conductivities(conductivity or []) or None,
        pieces=pieces,
        min_piece_share=min_piece_share,
        fill_holes=None if fill_holes else False,
        max_hole_mm=max_hole,
        weld_tolerance_mm=weld_tolerance,
        staircase=staircase or None,
        max_deviation_mm=max_deviation,
        max_volume_change=max_volume_change,
        max_area_change=max_area_change,
        min_gap_mm=min_gap,
    )
    _run(ctx, "heal", surfaces, unit, inputs, output, report)


def decimate(
    ctx: typer.Context,
    surfaces: SurfacesArgument,
    unit: UnitOption = "mm",
    ratio: Annotated[float | None, typer.Option(metavar="SHARE", help="Share of the faces that stays.")] = None,
    faces: Annotated[int | None, typer.Option(metavar="N", help="Largest number of faces of the result.")] = None,
    max_deviation: Annotated[
        float | None, typer.Option(metavar="MM", help="As few faces as keep result and original this near each other.")
    ] = None,
    method: Annotated[
        Literal["curvature", "quadric"], typer.Option(help="Flattest places first, or smallest distance to the former planes.")
    ] = "curvature",
    region: Annotated[
        list[str] | None, typer.Option(metavar="REGION", help=f"A box with a share of its own, in mm; repeat. {RATIO_FORM}")
    ] = None,
    smooth_weight: Annotated[
        float | None, typer.Option(metavar="WEIGHT", help="Smoothing around collapses, 0 to 1; default 0.8.")
    ] = None,
    literal: Annotated[bool, typer.Option("--literal", help="Appendix A of the thesis, without guards; for comparison.")] = False,
    min_gap: MinGapOption = None,
    conductivity: ConductivityOption = None,
    output: SurfaceOption = None,
    report: ReportOption = None,
) -> None:
    """Thin surfaces out where they are flattest, one or a whole package together."""
    targets = [
        name for name, value in (("--ratio", ratio), ("--faces", faces), ("--max-deviation", max_deviation)) if value is not None
    ]
    if len(targets) != 1:
        raise ArgumentError(
            f"exactly one of --ratio, --faces and --max-deviation is wanted, got {' and '.join(targets) or 'none'}"
        )
    inputs = given(
        conductivities_s_per_m=read_conductivities(conductivity or []) or None,
        target_ratio=ratio,
        target_faces=faces,
        max_deviation_mm=max_deviation,
        method=method,
        regions=[read_ratio_region(text) for text in region or ()] or None,
        smooth_weight=smooth_weight,
        literal=literal or None,
        min_gap_mm=min_gap,
    )
    _run(ctx, "decimate", surfaces, unit, inputs, output, report)


def smooth(
    ctx: typer.Context,
    surfaces: SurfacesArgument,
    unit: UnitOption = "mm",
    method: Annotated[
        Literal["standard", "lumped", "cvt", "wcc", "hc", "taubin"], typer.Option(help="Thesis Eqs. 3.1 to 3.4, Vollmer, Taubin.")
    ] = "hc",
    iterations: Annotated[int | None, typer.Option(metavar="N", help="At most so many; default 20.")] = None,
    stop: Annotated[
        Literal["quality", "iterations"] | None,
        typer.Option(help="End when the lowest quality no longer rises (default), or make all iterations."),
    ] = None,
    weight: Annotated[
        float | None, typer.Option(metavar="WEIGHT", help="Share of the way in one iteration, of Eqs. 3.1-3.4.")
    ] = None,
    along_surface: Annotated[bool, typer.Option("--along-surface", help="Keep vertices on the surface.")] = False,
    max_shift: Annotated[float | None, typer.Option(metavar="MM", help="No vertex goes farther from where it was.")] = None,
    retriangulate: Annotated[bool, typer.Option("--retriangulate", help="Flip edges towards Delaunay in between.")] = False,
    region: Annotated[
        list[str] | None, typer.Option(metavar="BOX", help=f"Smooth only in this box; repeat. {BOX_FORM} in mm")
    ] = None,
    min_gap: MinGapOption = None,
    conductivity: ConductivityOption = None,
    output: SurfaceOption = None,
    report: ReportOption = None,
) -> None:
    """Better triangles or less noise, without self-intersection."""
    inputs = given(
        conductivities_s_per_m=read_conductivities(conductivity or []) or None,
        method=method,
        iterations=iterations,
        stop=stop,
        weight=weight,
        along_surface=along_surface or None,
        max_shift_mm=max_shift,
        retriangulate=retriangulate or None,
        regions=[read_box(text) for text in region or ()] or None,
        min_gap_mm=min_gap,
    )
    _run(ctx, "smooth", surfaces, unit, inputs, output, report)


def separate(
    ctx: typer.Context,
    surfaces: SurfacesArgument,
    unit: UnitOption = "mm",
    fixed: Annotated[list[str] | None, typer.Option(metavar="NAME", help="A surface that may not move; repeat.")] = None,
    priority: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=N", help="Of two, the one with the higher number stays while the other has room; repeat."),
    ] = None,
    inside: Annotated[
        list[str] | None,
        typer.Option(metavar="INNER=OUTER", help="Which surface holds which most closely, where it is not plain; repeat."),
    ] = None,
    max_shift: Annotated[
        float | None, typer.Option(metavar="MM", help="No vertex goes farther from where it was; default 5.")
    ] = None,
    min_gap: Annotated[float | None, typer.Option(metavar="MM", help="Gap between every two surfaces; default 0.1.")] = None,
    conductivity: ConductivityOption = None,
    output: PackageOption = None,
    report: ReportOption = None,
) -> None:
    """Open a thin gap between surfaces that cross or touch, moving them as little as possible."""
    inputs = given(
        conductivities_s_per_m=read_conductivities(conductivity or []) or None,
        fixed=fixed or None,
        priority=read_priorities(priority or []) or None,
        inside=read_inside(inside or []) or None,
        max_shift_mm=max_shift,
        min_gap_mm=min_gap,
    )
    _run(ctx, "separate", surfaces, unit, inputs, output, report)


def tetrahedralize(
    ctx: typer.Context,
    surfaces: SurfacesArgument,
    unit: UnitOption = "mm",
    mesher: MesherOption = None,
    radius_edge: Annotated[
        float | None,
        typer.Option(metavar="RATIO", help="Largest ratio of circumradius to shortest edge, 1.1 to 10; default 2, 0 for none."),
    ] = None,
    max_volume: Annotated[
        list[str] | None, typer.Option(metavar="NAME=MM3", help="Largest tetrahedron of a tissue, in mm³; repeat.")
    ] = None,
    min_gap: MinGapOption = None,
    conductivity: ConductivityOption = None,
    output: VolumeOption = None,
    report: ReportOption = None,
) -> None:
    """Fill closed surfaces with tetrahedra, one region per tissue."""
    inputs = given(
        conductivities_s_per_m=read_conductivities(conductivity or []) or None,
        mesher=mesher,
        max_volume_mm3=read_volumes(max_volume or []) or None,
        min_gap_mm=min_gap,
    )
    if radius_edge is not None:
        inputs["radius_edge"] = radius_edge or None
    _run(ctx, "tetrahedralize", surfaces, unit, inputs, output, report, "vtu" if output and output.suffix == ".vtu" else "msh")


def _run(
    ctx: typer.Context,
    process: str,
    texts: list[str],
    unit: Unit,
    inputs: dict[str, Any],
    output: Path | None,
    report: Path | None,
    output_name: str | None = None,
) -> None:
    surfaces = read_surfaces(texts)
    wanted = Wanted.of(report, **{output_name or surfaces.output: output})
    run_process(ctx, process, inputs, wanted, lambda sending: sending.surfaces(surfaces, unit))
