"""Inputs of the process `decimate`."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from core.schema.model import FrozenModel
from core.schema.region_names import require_different_names
from core.schema.shells import Box
from core.schema.surfaces import SurfacesInputs
from core.schema.validate import MeshName

TARGETS = ("target_faces", "target_ratio", "max_deviation_mm")


class DecimateRegion(FrozenModel):
    """A part of the surfaces that is thinned to a degree of its own."""

    name: MeshName
    box_mm: Box
    ratio: float = Field(
        gt=0,
        le=1,
        description="Share of the faces in the box that stays; 1 leaves them as they are. Least share with max_deviation_mm",
    )


class DecimateParameters(FrozenModel):
    """How far to thin surfaces out: exactly one of `target_faces`, `target_ratio` and `max_deviation_mm`."""

    method: Literal["curvature", "quadric"] = Field(
        "curvature",
        description="`curvature`: flat places first, by the mean angle between neighbouring faces (the thesis' priority); "
        "`quadric`: smallest distance to the planes of the former faces first (Garland & Heckbert)",
    )
    target_faces: int | None = Field(
        None, ge=4, le=100_000_000, description="Largest number of faces of the result, shared by several surfaces in proportion"
    )
    target_ratio: float | None = Field(
        None, gt=0, le=1, description="Share of the faces that stays, of every surface; outside the regions"
    )
    max_deviation_mm: float | None = Field(
        None, gt=0, le=100, description="As few faces as possible while the result and the original stay this near, both ways"
    )
    regions: Annotated[tuple[DecimateRegion, ...], Field(max_length=64)] = Field(
        (), description="Boxes with a share of their own"
    )
    smooth_weight: float = Field(
        0.8, ge=0, le=1, description="How far vertices near a collapse move to the middle of their neighbours, along the surface"
    )
    literal: bool = Field(
        False,
        description="Appendix A of the thesis step for step, without guards or proof; may break the surface. For comparison",
    )

    @model_validator(mode="after")
    def _one_target(self) -> Self:
        given = [name for name in TARGETS if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"exactly one of {', '.join(TARGETS)} is wanted, got {' and '.join(given) or 'none'}")
        require_different_names([region.name for region in self.regions])
        return self

    @model_validator(mode="after")
    def _literal_stands_alone(self) -> Self:
        if self.literal and (self.method != "curvature" or self.max_deviation_mm is not None or self.regions):
            raise ValueError("literal is method curvature with target_faces or target_ratio, and knows no regions")
        return self


class DecimateInputs(DecimateParameters, SurfacesInputs):
    """Closed surfaces and how far to thin them: exactly one of `target_faces`, `target_ratio` and `max_deviation_mm`."""
