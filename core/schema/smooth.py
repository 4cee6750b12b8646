"""Inputs of the process `smooth`."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from core.schema.model import FrozenModel
from core.schema.region_names import require_different_names
from core.schema.shells import Box
from core.schema.surfaces import SurfacesInputs
from core.schema.validate import MeshName

Method = Literal["standard", "lumped", "cvt", "wcc", "hc", "taubin"]

OWN_PARAMETERS: dict[str, tuple[Method, ...]] = {
    "weight": ("standard", "lumped", "cvt", "wcc"),
    "equal_weights": ("cvt", "wcc"),
    "hc_alpha": ("hc",),
    "hc_beta": ("hc",),
    "taubin_lambda": ("taubin",),
    "taubin_mu": ("taubin",),
}


class SmoothRegion(FrozenModel):
    """A box in which vertices may move; all others keep their coordinates bit for bit."""

    name: MeshName
    box_mm: Box


class SmoothParameters(FrozenModel):
    """How to smooth. The defaults improve triangles and barely shrink: thesis 3.4 with the remedy it names."""

    method: Method = Field(
        "hc",
        description="`standard` Eq. 3.1, `lumped` Eq. 3.2, `cvt` Eq. 3.3, `wcc` Eq. 3.4, `hc` Vollmer 1999, `taubin` 1995; "
        "all vertices move at once",
    )
    iterations: int = Field(20, ge=1, le=1000, description="At most so many; one of `taubin` is a step in and a step out")
    stop: Literal["quality", "iterations"] = Field(
        "quality",
        description="`quality`: end when the lowest triangle quality no longer rises and deliver the best state; "
        "`iterations`: make and deliver all, to take noise out",
    )
    weight: float = Field(1.0, gt=0, le=1, description="Share of the way to the new place in one iteration; Eqs. 3.1-3.4 have 1")
    equal_weights: bool = Field(False, description="Eqs. 3.3 and 3.4 without areas: every triangle around a vertex counts alike")
    hc_alpha: float = Field(0.1, ge=0, le=1, description="`hc`: pull towards the original (1) or the previous (0) place")
    hc_beta: float = Field(0.6, gt=0.5, le=1, description="`hc`: share of a vertex' own push back, the rest is its neighbours'")
    taubin_lambda: float = Field(0.5, gt=0, le=1, description="`taubin`: share of the step in")
    taubin_mu: float = Field(-0.53, ge=-1.1, lt=0, description="`taubin`: share of the step out, larger than the step in")
    along_surface: bool = Field(
        False, description="Move vertices along the surface only: better triangles, the shape all but unchanged"
    )
    max_shift_mm: float | None = Field(None, gt=0, le=1000, description="No vertex goes farther from where it was")
    retriangulate: bool = Field(
        False,
        description="Flip edges towards Delaunay between iterations where the surface is nearly flat (thesis 3.4.2); "
        "faces change then, vertices keep their number",
    )
    regions: Annotated[tuple[SmoothRegion, ...], Field(max_length=64)] = Field(
        (), description="Boxes to smooth in; none: everything. The rims of open surfaces never move"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        for name, methods in OWN_PARAMETERS.items():
            # a job is stored with its defaults written down, so what was sent cannot be told from them
            if getattr(self, name) != type(self).model_fields[name].default and self.method not in methods:
                raise ValueError(f"{name} belongs to {' and '.join(methods)}, the method is {self.method}")
        if self.method == "taubin" and not -self.taubin_mu > self.taubin_lambda:
            raise ValueError(f"taubin_mu {self.taubin_mu} must step out farther than taubin_lambda {self.taubin_lambda} steps in")
        require_different_names([region.name for region in self.regions])
        return self


class SmoothInputs(SmoothParameters, SurfacesInputs):
    """Surfaces and how to smooth them. The defaults improve triangles and barely shrink: thesis 3.4 with the remedy it names."""
