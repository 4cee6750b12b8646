"""Inputs of the process `shells`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from core.schema.conductivities import ConductivityInputs
from core.schema.model import FrozenModel
from core.schema.reference import MeshReference
from core.schema.validate import MeshName

LARGEST_DEPTH_MM = 100.0
DepthMm = Annotated[float, Field(gt=0, le=LARGEST_DEPTH_MM, description="Distance to the skin in mm")]
ArrayName = Annotated[
    str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,62}$", description="Name of an array with one value per vertex of the upload")
]
Side = Literal["inside", "outside"]
SkinShiftMm = Annotated[
    float,
    Field(
        ge=0,
        le=5,
        description="Furthest the skin may move outwards where the body is too thin for the layers inside; 0 leaves it alone",
    ),
]
BlendMm = Annotated[float, Field(ge=0, le=100, description="Width over which the depth returns to the layer's own")]
ThinPolicy = Annotated[
    Literal["adapt", "fail"],
    Field(description="Where anatomy is thinner than a depth: `adapt` fades the depth smoothly, `fail` refuses the job"),
]
LayerName = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,47}$", description="A letter, then letters, digits, _ and -")]
Coordinates = tuple[float, float, float]
RESERVED_NAMES = ("skin", "package", "report", "report_html")  # outputs of the process itself


class Layer(FrozenModel):
    """One shell inside or outside the skin, at one distance to it or at a distance of its own at each vertex."""

    name: LayerName
    depth_mm: DepthMm | None = Field(None, description="Distance to the skin in mm; this or `depth_array`")
    depth_array: ArrayName | None = Field(
        None, description="Array of the skin's upload with the distance at each vertex, in mm whatever the unit of the upload"
    )
    side: Side = Field("inside", description="`outside` puts the shell around the skin instead of below it")

    @model_validator(mode="after")
    def _has_one_depth(self) -> Layer:
        if (self.depth_mm is None) == (self.depth_array is None):
            raise ValueError(f"layer '{self.name}' needs either depth_mm or depth_array")
        return self

    def signed(self, depth_mm: float) -> float:
        """A distance of this layer to the skin, counted inwards."""
        return depth_mm if self.side == "inside" else -depth_mm


class Box(FrozenModel):
    """An axis-aligned box in mm."""

    min: Coordinates
    max: Coordinates

    @model_validator(mode="after")
    def _has_volume(self) -> Box:
        if any(low >= high for low, high in zip(self.min, self.max, strict=True)):
            raise ValueError(f"box min {self.min} must be below max {self.max} on every axis")
        return self


class Region(FrozenModel):
    """A box with its own depths: full inside, blending to the layers' depths across `blend_mm` outside the wall."""

    name: MeshName
    box_mm: Box
    depths_mm: Annotated[dict[LayerName, DepthMm], Field(min_length=1)] = Field(description="Layer name -> depth")
    blend_mm: BlendMm = 5.0


Layers = Annotated[
    tuple[Layer, ...],
    Field(min_length=1, max_length=16, description="From outside inwards, so those outside the skin come first"),
]
DEFAULT_LAYERS = (Layer(name="fat", depth_mm=1.0), Layer(name="average_body", depth_mm=3.0))  # the thesis' full-body case


class ShellsInputs(ConductivityInputs):
    """A skin and the layers wanted, from outside inwards. The defaults are the thesis' full-body case."""

    skin: MeshReference = Field(description="The closed outer surface of a body")
    layers: Layers = DEFAULT_LAYERS
    regions: Annotated[tuple[Region, ...], Field(max_length=64)] = Field((), description="Boxes with their own depths")
    thin_policy: ThinPolicy = "adapt"
    min_gap_mm: float = Field(0.05, gt=0, le=10, description="Smallest distance allowed between two shells")
    skin_shift_mm: SkinShiftMm = 0.0

    @model_validator(mode="after")
    def _consistent(self) -> ShellsInputs:
        require_distinct(self.layers)
        for region in self.regions:
            require_ordered(f"region '{region.name}'", self.layers, region.depths_mm)
        require_tissues(self.conductivities_s_per_m, ["skin", *(layer.name for layer in self.layers)])
        return self


def require_distinct(layers: tuple[Layer, ...]) -> None:
    """Raises: ValueError unless the layers have names of their own and lie one below the other."""
    names = [layer.name for layer in layers]
    # they become file names, and some file systems do not tell cases apart
    if len({name.lower() for name in (*names, *RESERVED_NAMES)}) != len(names) + len(RESERVED_NAMES):
        raise ValueError(f"layer names must differ from each other and from {', '.join(RESERVED_NAMES)}: {names}")
    _require_inwards("layers", layers, {})


def require_tissues(conductivities: Mapping[str, float], tissues: Sequence[str]) -> None:
    """Raises: ValueError if a name is not among the tissues."""
    unknown = sorted(set(conductivities) - set(tissues))
    if unknown:
        raise ValueError(f"conductivities_s_per_m names {', '.join(unknown)}, the tissues are {', '.join(tissues)}")


def require_ordered(where: str, layers: tuple[Layer, ...], depths_mm: dict[str, float]) -> None:
    """Raises: ValueError unless the depths are of layers that exist and leave them one below the other."""
    unknown = sorted(set(depths_mm) - {layer.name for layer in layers})
    if unknown:
        raise ValueError(f"{where} names layers that do not exist: {unknown}")
    _require_inwards(where, layers, depths_mm)


def _require_inwards(where: str, layers: tuple[Layer, ...], depths_mm: dict[str, float]) -> None:
    """Depths that come from arrays are compared when the mesh is there; what is outside and what inside is known already."""
    sides = [layer.side for layer in layers]
    if sides != sorted(sides, reverse=True):
        raise ValueError(f"{where}: layers run from outside inwards, those outside the skin first; got {', '.join(sides)}")
    told = [(layer, depths_mm.get(layer.name, layer.depth_mm)) for layer in layers]
    known = [(layer, depth) for layer, depth in told if depth is not None]
    if any(inner.signed(lower) <= outer.signed(upper) for (outer, upper), (inner, lower) in pairwise(known)):
        depths = ", ".join(f"{layer.name} {depth:g} mm {layer.side}" for layer, depth in known)
        raise ValueError(f"{where}: depths must increase inwards, and outside the skin decrease; got {depths}")
