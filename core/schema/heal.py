"""Inputs of the process `heal`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from core.schema.model import FrozenModel
from core.schema.surfaces import SurfacesInputs

PiecesPolicy = Literal["keep_largest", "keep_above", "keep_all"]
Share = Annotated[float, Field(ge=0, le=1)]


class HealParameters(FrozenModel):
    """What may be mended, and how much of the surface may change. The defaults suit the skin of a body: one closed surface."""

    pieces: PiecesPolicy = Field(
        "keep_largest",
        description="`keep_largest` keeps the piece with the largest area, `keep_above` those with at least `min_piece_share` of "
        "that area, `keep_all` every piece that encloses a volume; a closed piece inside another is a cavity",
    )
    min_piece_share: Share = Field(0.01, description="For `keep_above`: smallest area of a piece, as share of the largest one")
    fill_holes: bool = Field(True, description="False refuses a surface whose borders cannot be welded")
    max_hole_mm: float | None = Field(
        None, gt=0, description="Longest rim of a hole that is filled; a longer one refuses the job. Default: no limit"
    )
    weld_tolerance_mm: float | None = Field(
        None,
        ge=0,
        le=10,
        description="Borders at most this far apart are joined. Default: a share of the edge lengths at the border",
    )
    staircase: bool = Field(False, description="Smooth the steps of a surface that was made from voxels")
    staircase_max_mm: float = Field(0.5, gt=0, le=10, description="How far smoothing of steps may move a vertex")
    max_volume_change: Share = Field(0.05, description="Largest change of the enclosed volume, as share of it")
    max_area_change: Share = Field(
        0.25, description="Largest area taken away, and largest area added, as share of the area of the surface"
    )
    max_deviation_mm: float = Field(
        5.0,
        gt=0,
        le=1000,
        description="How far the surface may move, two-sided. Not counted: pieces, fins and inner walls that are taken away, "
        "and patches over holes; they count as area",
    )


class HealInputs(HealParameters, SurfacesInputs):
    """What may be mended, and how much of the surface may change. The defaults suit the skin of a body: one closed surface."""
