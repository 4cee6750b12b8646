"""Options that several commands have, declared once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import typer

from integument.cli.layer_text import REGION_FORM
from integument.surface_processes import Unit

SkinArgument: TypeAlias = Annotated[
    str, typer.Argument(help="Mesh file (STL, MAT, PLY, OBJ), or /v1/meshes/{id} of one the server holds.")
]
SurfacesArgument: TypeAlias = Annotated[
    list[str],
    typer.Argument(
        help="A mesh file, /v1/meshes/{id} or /v1/jobs/{id}/results/{output}; several are treated together; or a package: "
        "/v1/jobs/{id}/results/package or a package.zip."
    ),
]
UnitOption: TypeAlias = Annotated[Unit, typer.Option(help="Unit of the coordinates in the files.")]
LayerOption: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=DEPTH",
        help="Layer and its depth in mm, or the name of an array of the upload with the depth at each vertex; repeat, from "
        "outside inwards. Default fat=1 average_body=3.",
    ),
]
OuterLayerOption: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME=DEPTH", help="Layer around the skin and its distance to it in mm; repeat, from outside inwards."),
]
RegionOption: TypeAlias = Annotated[
    list[str] | None, typer.Option(metavar="REGION", help=f"A box with its own depths, in mm; repeat. {REGION_FORM}")
]
CanalOption: TypeAlias = Annotated[
    list[str] | None, typer.Option(metavar="MESH", help="Closed mesh of a canal's air, to be cut out of the skin; repeat.")
]
GenerateCanalsOption: TypeAlias = Annotated[
    bool, typer.Option("--generate-canals", help="Cut a canal of usual shape into each ear found.")
]
EarDepthOption: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME=DEPTH", help="Depth of a layer in the ears, in mm. Default fat=0.3 average_body=0.6."),
]
BlendOption: TypeAlias = Annotated[
    float | None, typer.Option(metavar="MM", help="Width over which the depths return; default 5.")
]
ThinPolicyOption: TypeAlias = Annotated[
    Literal["adapt", "fail"], typer.Option(help="Where anatomy is thinner than a depth: fade the depth, or refuse.")
]
ConductivityOption: TypeAlias = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME=S/M", help="Conductivity of a tissue, in place of the default of its name; repeat."),
]
MesherOption: TypeAlias = Annotated[
    Literal["auto", "tetgen", "gmsh"] | None,
    typer.Option(
        help="Who makes the tetrahedra; default auto: tetgen, and gmsh where that gives up. gmsh takes longer and leaves fewer "
        "flat ones."
    ),
]
MinGapOption: TypeAlias = Annotated[
    float | None, typer.Option(metavar="MM", help="Smallest distance allowed between two surfaces; default is the server's.")
]
SkinShiftOption: TypeAlias = Annotated[
    float | None,
    typer.Option(metavar="MM", help="Furthest the skin may move outwards where the body is too thin; default 0, at most 5."),
]
PackageOption: TypeAlias = Annotated[Path | None, typer.Option("--output", "-o", help="Where to put the package, a zip.")]
SurfaceOption: TypeAlias = Annotated[
    Path | None,
    typer.Option(
        "--output", "-o", help="Where to put the surface, an STL; of several surfaces or a package: the package, a zip."
    ),
]
VolumeOption: TypeAlias = Annotated[
    Path | None,
    typer.Option("--output", "-o", help="Where to put the tetrahedra: gmsh 2.2 for SimNIBS, or VTU if it ends in .vtu."),
]
ReportOption: TypeAlias = Annotated[
    Path | None, typer.Option("--report", dir_okay=False, help="Where to put the report, a self-contained HTML page.")
]
NameOption: TypeAlias = Annotated[str | None, typer.Option("--name", help="What people call it.")]
LabelOption: TypeAlias = Annotated[list[str] | None, typer.Option("--label", metavar="LABEL", help="To find it by; repeat.")]
