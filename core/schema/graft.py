"""Inputs of the process `graft`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from core.schema.model import FrozenModel
from core.schema.reference import MeshReference
from core.schema.region_names import require_different_names
from core.schema.shells import Box
from core.schema.validate import MeshName


class GraftRegion(FrozenModel):
    """What to take from the donor."""

    name: MeshName
    box_mm: Box


class GraftInputs(FrozenModel):
    """Base and donor are closed surfaces that run near each other at the walls of the regions, such as two shells of one skin."""

    base: MeshReference = Field(description="The surface that stays outside of the boxes")
    donor: MeshReference = Field(description="The surface that is taken inside of the boxes")
    regions: Annotated[tuple[GraftRegion, ...], Field(min_length=1, max_length=16)] = Field(
        description="Boxes taken out of the base and filled from the donor; where they overlap they are one"
    )
    seam_mm: float = Field(
        3.0,
        ge=0.2,
        le=50,
        description="Width of the strip along the walls that is triangulated anew, where base and donor permit",
    )
    max_distance_mm: float = Field(
        5.0, gt=0, le=50, description="Largest distance between base and donor at the walls that is bridged"
    )

    @model_validator(mode="after")
    def _names_differ(self) -> GraftInputs:
        require_different_names([region.name for region in self.regions])
        return self
