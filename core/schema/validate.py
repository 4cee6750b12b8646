"""Inputs of the process `validate`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from core.schema.model import FrozenModel
from core.schema.reference import MeshReference

MeshName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$", description="Letters, digits, _ and -")]


class ValidateInputs(FrozenModel):
    """One to sixty-four meshes; a set is also checked against each other."""

    meshes: (
        MeshReference
        | Annotated[list[MeshReference], Field(min_length=1, max_length=64)]
        | Annotated[dict[MeshName, MeshReference], Field(min_length=1, max_length=64)]
    ) = Field(description="One reference, a list (named after the uploads), or an object of name -> reference")
    min_gap_mm: float = Field(
        0.0, ge=0, le=100, description="Meshes of the set closer than this are an error; 0 asks only that they do not touch"
    )
