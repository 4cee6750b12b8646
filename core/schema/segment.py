"""Inputs of the process `segment`."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from core.schema.conductivities import ConductivityInputs
from core.schema.model import FrozenModel
from core.schema.reference import VolumeReference
from core.schema.surfaces import RESERVED_NAMES
from core.schema.validate import MeshName

LabelNumber = Annotated[str, Field(pattern=r"^[1-9][0-9]{0,4}$", description="A label of the volume, 1 to 65535")]


class SegmentParameters(FrozenModel):
    """Which labels become surfaces, and how."""

    names: Annotated[dict[LabelNumber, MeshName], Field(max_length=1024)] = Field(
        {},
        description='Label -> name of its surface, as `{"2": "white_matter", "41": "white_matter"}`: labels of one name become '
        "one surface",
    )
    others: Literal["auto", "include", "ignore"] = Field(
        "auto",
        description="Labels without a name: `include` calls them label_<number>, `ignore` takes them as nothing, `auto` ignores "
        "them if there are names",
    )
    islands: Literal["keep_largest", "keep_above", "keep_all"] = Field(
        "keep_largest", description="Pieces of a label: the largest, those of `min_island_mm3` or more, or all"
    )
    min_island_mm3: float = Field(100.0, gt=0, description="For `keep_above`: smallest volume of a piece that stays")
    cavities: Literal["fill", "keep"] = Field(
        "fill",
        description="`fill`: a surface is the outer border of its label, what the label encloses lies within it, as packages "
        "have it; `keep`: borders of cavities belong to the surface, too",
    )
    inside: Annotated[dict[MeshName, MeshName], Field(max_length=64)] = Field(
        {},
        description="Surface -> the one that holds it most closely: the outer one is drawn around both, though their labels lie "
        "side by side; where the inner one comes to its border it gives up a voxel. For shells as solvers want them: "
        '`{"white_matter": "grey_matter", "grey_matter": "csf"}`',
    )
    smoothing: int = Field(10, ge=0, le=100, description="Steps of Taubin smoothing, within 0.3 of a voxel; 0: none")
    faces_share: float = Field(
        0.33, gt=0, le=1, description="Share of the faces of the first surface, about 9 per voxel, that stays"
    )

    @property
    def includes_others(self) -> bool:
        """True if labels without a name become surfaces, too."""
        return self.others == "include" or (self.others == "auto" and not self.names)

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.inside and self.cavities == "keep":
            raise ValueError("inside does not go with cavities keep: a surface that holds others is its outer border")
        for name in self.inside:
            if name in self.holders_of(name):
                raise ValueError(f"nothing can be inside itself: {' inside '.join((name, *self.holders_of(name)))}")
        return self

    def holders_of(self, name: str) -> tuple[str, ...]:
        """All surfaces said to hold one, the closest first; the name itself comes last if it goes round in a circle."""
        found: list[str] = []
        holder = self.inside.get(name)
        while holder is not None and holder not in found:
            found.append(holder)
            holder = self.inside.get(holder)
        return tuple(found)

    @model_validator(mode="after")
    def _distinct(self) -> Self:
        names = sorted(set(self.names.values()))
        # names become outputs and files, and some file systems do not tell cases apart
        if len({name.lower() for name in (*names, *RESERVED_NAMES)}) != len(names) + len(RESERVED_NAMES):
            raise ValueError(f"names must differ from each other and from {', '.join(RESERVED_NAMES)}: {names}")
        return self


class SegmentInputs(ConductivityInputs, SegmentParameters):
    """A volume of labels, and what becomes of it."""

    volume: VolumeReference = Field(description="An uploaded label volume (NIfTI, MGZ)")
    min_gap_mm: float = Field(
        0.1, gt=0, le=10, description="Smallest distance between two surfaces; at most a quarter of the smallest side of a voxel"
    )
