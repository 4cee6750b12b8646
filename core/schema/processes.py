"""The catalogue of processes: ids, titles, inputs, outputs. `core.processes` holds a handler for each of them."""

from __future__ import annotations

from typing import Literal

from core.schema.decimate import DecimateInputs
from core.schema.detach import DetachInputs
from core.schema.ears import EarsInputs
from core.schema.fields import FieldsInputs
from core.schema.graft import GraftInputs
from core.schema.heal import HealInputs
from core.schema.model import FrozenModel
from core.schema.prepare import PrepareInputs
from core.schema.segment import SegmentInputs
from core.schema.separate import SeparateInputs
from core.schema.shells import ShellsInputs
from core.schema.smooth import SmoothInputs
from core.schema.tetrahedralize import TetrahedralizeInputs
from core.schema.validate import ValidateInputs

MediaType = Literal[
    "application/zip", "application/json", "text/html", "text/csv", "model/stl", "application/x-gmsh", "application/x-vtu"
]


class OutputDescription(FrozenModel):
    """One output of a process."""

    title: str
    media_type: MediaType
    description: str


class ProcessDescription(FrozenModel):
    """What a client needs to know before it sends a job."""

    id: str
    version: str
    title: str
    description: str
    keywords: tuple[str, ...]
    inputs: type[FrozenModel]
    outputs: dict[str, OutputDescription]
    names_layers: bool = False
    """True if every layer asked for is an output of its own besides (`results/fat`), ready to be chained."""
    names_surfaces: bool = False
    """True if every surface is an output under its own name: `mesh` if one came alone, else beside the package."""
    names_tissues: bool = False
    """True if every inner tissue asked for is an output of its own besides, named after it."""
    more_attempts: int = 0
    """Attempts a job gets beyond the server's usual number. A chain of many steps goes on where the attempt before it ended, so
    the loss of two workers on the way need not be its end."""
    starts_processes: bool = False
    """True if it forks, for a library that may crash; only then the kernel lets its child do so."""


_REPORT = OutputDescription(title="Report", media_type="application/json", description="Numbers and findings, see docs")
_REPORT_HTML = OutputDescription(
    title="Report for people", media_type="text/html", description="Self-contained page with figures"
)

VALIDATE = ProcessDescription(
    id="validate",
    version="1.0.0",
    title="Validate meshes",
    description="Prove that surfaces are closed, manifold, outward, free of self-intersection, nested and apart, "
    "with exact predicates; verdict simulation_ready or not_ready.",
    keywords=("validation", "manifold", "self-intersection", "nesting"),
    inputs=ValidateInputs,
    outputs={"report": _REPORT, "report_html": _REPORT_HTML},
)
SHELLS = ProcessDescription(
    id="shells",
    version="1.0.0",
    title="Create nested shells",
    description="Closed nested layers at given depths below the skin, thinner where anatomy is thin, proven free of "
    "intersections of any kind in the delivered files.",
    keywords=("shells", "skin", "fat", "average body", "offset"),
    inputs=ShellsInputs,
    outputs={
        "package": OutputDescription(
            title="Package", media_type="application/zip", description="Meshes, solver files, manifest and report"
        ),
        "report": _REPORT,
        "report_html": _REPORT_HTML,
        "skin": OutputDescription(title="Skin", media_type="model/stl", description="The skin as delivered, float32"),
    },
    names_layers=True,
)
EARS = ProcessDescription(
    id="ears",
    version="1.0.0",
    title="Create nested shells with thin ears and ear canals",
    description="Finds both ears or takes their boxes, cuts canals into the skin and remeshes the seams, then creates nested "
    "shells that are thinner in the ears and canals, proven as those of `shells`.",
    keywords=("ears", "ear canal", "variable thickness", "shells"),
    inputs=EarsInputs,
    outputs={
        **SHELLS.outputs,
        "skin": OutputDescription(title="Skin", media_type="model/stl", description="The skin with canals as delivered, float32"),
    },
    names_layers=True,
)
GRAFT = ProcessDescription(
    id="graft",
    version="1.0.0",
    title="Graft a region",
    description="Take regions out of a base surface, set those of a donor surface in, and join them by new triangles to one "
    "closed, manifold, outward surface, proven free of self-intersection in the delivered file. Works across connectivities.",
    keywords=("graft", "region", "ears", "seam", "re-triangulation"),
    inputs=GraftInputs,
    outputs={
        "mesh": OutputDescription(title="Joined surface", media_type="model/stl", description="Base with the donor's regions"),
        "report": _REPORT,
        "report_html": _REPORT_HTML,
    },
)
_OF_SURFACES = {
    "mesh": OutputDescription(
        title="Surface", media_type="model/stl", description="The surface as delivered, float32; if one came"
    ),
    "package": OutputDescription(
        title="Package",
        media_type="application/zip",
        description="All surfaces with solver files, manifest and report; if several came, or a package",
    ),
    "report": _REPORT,
    "report_html": _REPORT_HTML,
}
HEAL = ProcessDescription(
    id="heal",
    version="1.0.0",
    title="Heal surfaces",
    description="Make defective surfaces closed, manifold, outward and free of self-intersection with the smallest change: "
    "cracks, holes, T-junctions, duplicates, orientation, pieces, self-intersections. Lists every change; refuses rather than "
    "destroy.",
    keywords=("heal", "repair", "holes", "self-intersection", "manifold"),
    inputs=HealInputs,
    outputs=_OF_SURFACES,
    names_surfaces=True,
)
DECIMATE = ProcessDescription(
    id="decimate",
    version="1.0.0",
    title="Decimate surfaces",
    description="Fewer faces where the surface is flattest, to a number, a ratio or a largest deviation, with regions of their "
    "own; same topology, no new self-intersection, several surfaces kept apart, deviation measured both ways.",
    keywords=("decimation", "simplification", "curvature", "quadric error", "nested shells"),
    inputs=DecimateInputs,
    outputs=_OF_SURFACES,
    names_surfaces=True,
)
SMOOTH = ProcessDescription(
    id="smooth",
    version="1.0.0",
    title="Smooth surfaces",
    description="Better triangles or less noise by Laplacian, lumped, CVT, WCC, HC or Taubin smoothing, in regions or "
    "everywhere, without self-intersection; stops when quality no longer rises, reports the drift of volume.",
    keywords=("smoothing", "Laplacian", "triangle quality", "HC", "Taubin"),
    inputs=SmoothInputs,
    outputs=_OF_SURFACES,
    names_surfaces=True,
)
DETACH = ProcessDescription(
    id="detach",
    version="1.0.0",
    title="Set touching parts of a body apart",
    description="Where parts of a skin are grown together, such as arm and torso or two fingers, the smallest surface between "
    "them is found in the regions given and a gap opened along it; smooth new skin on both sides, nothing outside of the regions "
    "changed, proven free of self-intersection in the delivered file.",
    keywords=("detach", "contact", "arms", "torso", "fingers", "gap"),
    inputs=DetachInputs,
    outputs={
        "skin": OutputDescription(title="Skin", media_type="model/stl", description="The skin with its contacts open, float32"),
        "report": _REPORT,
        "report_html": _REPORT_HTML,
    },
)
SEPARATE = ProcessDescription(
    id="separate",
    version="1.0.0",
    title="Separate tissues",
    description="Open a thin gap between every two surfaces that cross or touch, nested or side by side, by moving vertices as "
    "little as possible; who may move, who stays and who has priority is yours to say. Proven free of intersections, or refused "
    "with the places that have no room.",
    keywords=("separate", "gap", "intersection", "tissues", "nested surfaces"),
    inputs=SeparateInputs,
    outputs={name: output for name, output in _OF_SURFACES.items() if name != "mesh"},
    names_surfaces=True,
)
SEGMENT = ProcessDescription(
    id="segment",
    version="1.0.0",
    title="Make surfaces of labels",
    description="A label volume (NIfTI or MGZ, any orientation, uneven voxels) to one closed manifold surface per label: smooth "
    "below the size of a voxel without shrinkage, neighbours kept apart by a gap, islands and cavities as asked, proven free of "
    "intersections in the delivered files.",
    keywords=("segmentation", "labels", "NIfTI", "voxels", "surface", "isosurface"),
    inputs=SegmentInputs,
    names_surfaces=True,
    outputs={
        "package": OutputDescription(
            title="Package", media_type="application/zip", description="All surfaces with solver files, manifest and report"
        ),
        "report": _REPORT,
        "report_html": _REPORT_HTML,
    },
)
TETRAHEDRALIZE = ProcessDescription(
    id="tetrahedralize",
    version="1.0.0",
    title="Fill surfaces with tetrahedra",
    description="A conforming volume mesh with one region per tissue, no vertex added on a surface, each region's volume proven; "
    "for SimNIBS, gmsh and ParaView. Surfaces that cannot be filled are refused with the faces at fault.",
    keywords=("tetrahedra", "FEM", "volume mesh", "TetGen", "SimNIBS"),
    inputs=TetrahedralizeInputs,
    starts_processes=True,
    outputs={
        "msh": OutputDescription(
            title="Volume mesh", media_type="application/x-gmsh", description="gmsh 2.2 binary: triangles 1000 + n, tetrahedra n"
        ),
        "vtu": OutputDescription(
            title="Volume mesh for ParaView", media_type="application/x-vtu", description="Tetrahedra, tissue and conductivity"
        ),
        "report": _REPORT,
        "report_html": _REPORT_HTML,
    },
)
FIELDS = ProcessDescription(
    id="fields",
    version="1.0.0",
    title="Bring a field onto surfaces",
    description="The electric field of a solver (a gmsh file as SimNIBS writes it, or a matrix of text) as one value per "
    "triangle on any surfaces, with the distance to what it was taken from; nothing is extrapolated in silence. Numbers per "
    "surface, pictures, files for MATLAB, ParaView and gmsh; a coil may be drawn beside the head.",
    keywords=("electric field", "TMS", "SimNIBS", "coil", "ElementData", "mapping"),
    inputs=FieldsInputs,
    outputs={
        "fields": OutputDescription(
            title="All files", media_type="application/zip", description="MATLAB, ParaView and gmsh files, numbers, figures"
        ),
        "msh": OutputDescription(
            title="Surfaces with the field",
            media_type="application/x-gmsh",
            description="gmsh 2.2 binary with E and magnE as ElementData",
        ),
        "statistics": OutputDescription(
            title="Numbers", media_type="text/csv", description="Mean, 99th percentile and maximum per surface, and where it is"
        ),
        "report": _REPORT,
        "report_html": _REPORT_HTML,
    },
)
PREPARE = ProcessDescription(
    id="prepare",
    version="1.0.0",
    title="Prepare a model, all steps in one",
    description="From a skin to a model in one job: heal, decimate, detach, smooth, ears and canals, nested layers, inner "
    "tissues set apart, proof on the delivered files, tetrahedra, package. Each step may be left out; a step that is done is "
    "not done again after a crash or a retry, and if one fails the results before it are left.",
    keywords=("prepare", "pipeline", "shells", "ears", "inner tissues", "tetrahedra"),
    inputs=PrepareInputs,
    starts_processes=True,
    more_attempts=2,
    names_layers=True,
    names_tissues=True,
    outputs={
        **SHELLS.outputs,
        "skin": OutputDescription(
            title="Skin", media_type="model/stl", description="The skin as the steps left it, float32; a failed job has it too"
        ),
        "msh": TETRAHEDRALIZE.outputs["msh"],
        "vtu": TETRAHEDRALIZE.outputs["vtu"],
        "steps": OutputDescription(
            title="Steps",
            media_type="application/json",
            description="Each step: outcome, numbers, faces before and after, seconds, whether an attempt before had done it",
        ),
    },
)
PROCESSES: dict[str, ProcessDescription] = {
    process.id: process
    for process in (
        VALIDATE,
        SHELLS,
        EARS,
        GRAFT,
        HEAL,
        DECIMATE,
        SMOOTH,
        DETACH,
        SEGMENT,
        SEPARATE,
        TETRAHEDRALIZE,
        FIELDS,
        PREPARE,
    )
}
