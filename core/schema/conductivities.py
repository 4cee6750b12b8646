"""Conductivities that a caller gives instead of the defaults."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from core.schema.model import FrozenModel
from core.schema.validate import MeshName

Conductivity = Annotated[float, Field(ge=0, le=1e8, allow_inf_nan=False)]  # silver has 6.3e7
OwnConductivities = Annotated[
    dict[MeshName, Conductivity],
    Field(
        max_length=64,
        description="Tissue -> S/m at your frequency, in place of the default of its name or of what its package has; the "
        "defaults are quasi-static",
    ),
]


class ConductivityInputs(FrozenModel):
    """What a process that makes packages or volume meshes is asked about conductivities."""

    conductivities_s_per_m: OwnConductivities = {}
