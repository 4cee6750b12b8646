"""Inputs of the process `tetrahedralize`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from core.schema.model import FrozenModel
from core.schema.surfaces import SurfacesInputs
from core.schema.validate import MeshName


class TetrahedraParameters(FrozenModel):
    """How fine and how well shaped tetrahedra are to be."""

    radius_edge: float | None = Field(
        2.0,
        ge=1.1,
        le=10,
        description="Largest ratio of circumradius to shortest edge, wherever the surfaces allow it; smaller means better "
        "shaped and more tetrahedra; null adds no vertex but where there must be one",
    )
    max_volume_mm3: Annotated[dict[MeshName, Annotated[float, Field(gt=0)]], Field(max_length=64)] = Field(
        {}, description="Surface name -> largest tetrahedron of its tissue in mm³, wherever the surfaces allow it"
    )


class TetrahedralizeInputs(TetrahedraParameters, SurfacesInputs):
    """Closed surfaces, nested or side by side, that touch nowhere; the outermost have air around them."""
