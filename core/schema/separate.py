"""Inputs of the process `separate`."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field, model_validator
from pydantic.json_schema import SkipJsonSchema

from core.schema.surfaces import SurfacesInputs
from core.schema.validate import MeshName

Priority = Annotated[int, Field(ge=-100, le=100)]


class SeparateInputs(SurfacesInputs):
    """Tissues that cross or touch, the gap wanted between every two of them, and who may move for it."""

    subjects: ClassVar[tuple[str, ...]] = ("meshes", "package")
    mesh: SkipJsonSchema[None] = Field(None, exclude=True)
    """One surface alone has nothing to be apart from: no form offers it."""
    min_gap_mm: float = Field(0.1, gt=0, le=10, description="Gap to open between every two surfaces")
    fixed: Annotated[tuple[MeshName, ...], Field(max_length=64)] = Field(
        (), description="Surfaces that keep their coordinates bit for bit; all others may move"
    )
    priority: Annotated[dict[MeshName, Priority], Field(max_length=64)] = Field(
        {}, description="Of two that may move, the one with the higher number stays while the other has room; 0 if not named"
    )
    inside: Annotated[dict[MeshName, MeshName | None], Field(max_length=64)] = Field(
        {},
        description="Surface -> the one that holds it most closely, null for none. Who is not named is found by where most of it "
        "lies",
    )
    max_shift_mm: float = Field(5.0, gt=0, le=100, description="No vertex goes farther from where it was")

    @model_validator(mode="before")
    @classmethod
    def _several(cls, sent: Any) -> Any:
        meshes = sent.get("meshes") if isinstance(sent, dict) else None
        if isinstance(sent, dict) and (sent.get("mesh") is not None or (isinstance(meshes, dict) and len(meshes) < 2)):
            raise ValueError("one surface has nothing to be apart from: name two or more in meshes, or a package")
        return sent
