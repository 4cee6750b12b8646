"""Inputs of the process `tetrahedralize`."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from core.schema.model import FrozenModel
from core.schema.surfaces import SurfacesInputs
from core.schema.validate import MeshName

RADIUS_EDGE = 2.0


class TetrahedraParameters(FrozenModel):
    """Who makes tetrahedra, and how fine and how well shaped they are to be."""

    mesher: Literal["auto", "tetgen", "gmsh"] = Field(
        "auto",
        description="Both keep the surfaces as they are. TetGen is faster; gmsh leaves far fewer flat tetrahedra, and fills some "
        "sets that TetGen gives up on. `auto`: TetGen, and gmsh for those; the report says who made them",
    )
    radius_edge: float | None = Field(
        RADIUS_EDGE,
        ge=1.1,
        le=10,
        description="TetGen's alone: largest ratio of circumradius to shortest edge, wherever the surfaces allow it; smaller "
        "means better shaped and more tetrahedra; null adds no vertex but where there must be one",
    )
    max_volume_mm3: Annotated[dict[MeshName, Annotated[float, Field(gt=0)]], Field(max_length=64)] = Field(
        {}, description="Surface name -> largest tetrahedron of its tissue in mm³, wherever the surfaces allow it"
    )

    @model_validator(mode="after")
    def _known_to_the_mesher(self) -> Self:
        if self.mesher == "gmsh" and self.radius_edge != RADIUS_EDGE:
            raise ValueError("radius_edge is TetGen's: leave it out with mesher gmsh")
        return self


class TetrahedralizeInputs(TetrahedraParameters, SurfacesInputs):
    """Closed surfaces, nested or side by side, that touch nowhere; the outermost have air around them."""
