"""Inputs of the process `ears`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from core.schema.conductivities import ConductivityInputs
from core.schema.model import FrozenModel
from core.schema.reference import MeshReference
from core.schema.shells import (
    DEFAULT_LAYERS,
    BlendMm,
    Box,
    DepthMm,
    LayerName,
    Layers,
    Region,
    ShellsInputs,
    SkinShiftMm,
    ThinPolicy,
    require_distinct,
    require_ordered,
    require_tissues,
)
from core.schema.validate import MeshName

EarDepths = Annotated[dict[LayerName, DepthMm], Field(min_length=1)]
THESIS_DEPTHS_MM = {"fat": 0.3, "average_body": 0.6}


class EarRegion(FrozenModel):
    """A box round one ear. What is left out is as for all ears, so a region of an earlier report fits here too."""

    name: MeshName
    box_mm: Box
    depths_mm: EarDepths | None = Field(None, description="Layer name -> depth in this ear; default is `ear_depths_mm`")
    blend_mm: float | None = Field(None, ge=0, le=100, description="Default is the job's `blend_mm`")


class CanalShape(FrozenModel):
    """A round tube in the shape of an S, for skins without a segmented canal."""

    radius_mm: float = Field(3.5, ge=1, le=6, description="Of the tube")
    length_mm: float = Field(25.0, ge=14, le=40, description="From the floor of the concha to the end")
    bend_mm: float = Field(2.0, ge=0, le=3.5, description="Swing of the S to either side")


EarBoxes = Annotated[tuple[EarRegion, ...], Field(min_length=1, max_length=8)]
Canals = Annotated[
    tuple[MeshReference, ...],
    Field(max_length=8, description="Closed meshes of the ear canals' air, reaching out of the skin; they are cut out of it"),
]
GeneratedCanals = Annotated[
    CanalShape | None,
    Field(description="Cut a canal of this shape into each ear found; only with ears `auto` and without `canals`"),
]
OtherRegions = Annotated[tuple[Region, ...], Field(max_length=32, description="Other boxes with their own depths")]


class EarsInputs(ConductivityInputs):
    """A skin whose ears get thinner layers. The defaults are the thesis' case (6.4)."""

    skin: MeshReference = Field(description="The closed outer surface of a body")
    ears: Literal["auto"] | EarBoxes = Field("auto", description="`auto` finds both ears of a whole body; otherwise their boxes")
    canals: Canals = ()
    generate_canals: GeneratedCanals = None
    layers: Layers = DEFAULT_LAYERS
    ear_depths_mm: EarDepths = Field(
        THESIS_DEPTHS_MM, description="Layer name -> depth in the ears and in the walls of their canals"
    )
    blend_mm: BlendMm = 5.0
    regions: OtherRegions = ()
    thin_policy: ThinPolicy = "adapt"
    min_gap_mm: float = Field(0.05, gt=0, le=10, description="Smallest distance allowed between two shells")
    skin_shift_mm: SkinShiftMm = 0.0

    @model_validator(mode="after")
    def _consistent(self) -> EarsInputs:
        require_distinct(self.layers)
        require_ordered("ear_depths_mm", self.layers, self.ear_depths_mm)
        require_tissues(self.conductivities_s_per_m, ["skin", *(layer.name for layer in self.layers)])
        depths = [(region.name, region.depths_mm) for region in self.regions]
        if self.ears != "auto":
            depths += [(ear.name, ear.depths_mm) for ear in self.ears if ear.depths_mm is not None]
        for name, depths_mm in depths:
            require_ordered(f"region '{name}'", self.layers, depths_mm)
        if self.generate_canals is not None and (self.canals or self.ears != "auto"):
            raise ValueError("generate_canals goes with ears 'auto' and without canals")
        return self

    def as_shells(self, ears: tuple[Region, ...]) -> ShellsInputs:
        """The same request with the ears as plain regions."""
        return ShellsInputs(
            skin=self.skin,
            layers=self.layers,
            regions=(*ears, *self.regions),
            thin_policy=self.thin_policy,
            min_gap_mm=self.min_gap_mm,
            skin_shift_mm=self.skin_shift_mm,
            conductivities_s_per_m=self.conductivities_s_per_m,
        )
