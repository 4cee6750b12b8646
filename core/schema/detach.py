"""Inputs of the process `detach`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from core.schema.model import FrozenModel
from core.schema.reference import MeshReference
from core.schema.region_names import require_different_names
from core.schema.shells import Box
from core.schema.validate import MeshName


class ContactRegion(FrozenModel):
    """A box with both parts and where they touch, and as little else as possible."""

    name: MeshName
    box_mm: Box
    contacts: int = Field(1, ge=1, le=8, description="Contacts in the box that are opened; another number refuses the job")


class DetachSettings(FrozenModel):
    """Where parts of a body touch, and how far they are set apart."""

    regions: Annotated[tuple[ContactRegion, ...], Field(min_length=1, max_length=16)] = Field(
        description="Boxes around contacts, such as arm and torso; nothing outside of them changes"
    )
    gap_mm: float = Field(1.0, ge=0.05, le=20, description="Smallest distance between the two parts where they touched")
    pieces: int = Field(
        1, ge=1, le=16, description="Pieces wanted in the end: 1 if the parts hang together elsewhere, as arm and torso do"
    )
    narrowing: float = Field(
        0.8,
        gt=0,
        lt=1,
        description="A contact is where the body is at most this share as thick as the thinner of the two parts; with a sharp "
        "crease around it, up to 0.95",
    )
    max_contact_cm2: float = Field(
        250.0, gt=0, le=10_000, description="Largest contact that is opened: a larger cut would go through more than a contact"
    )

    @model_validator(mode="after")
    def _names_differ(self) -> DetachSettings:
        require_different_names([region.name for region in self.regions])
        return self


class DetachInputs(DetachSettings):
    """A closed skin whose parts are grown together where they touch."""

    skin: MeshReference = Field(description="A closed skin whose parts are grown together or run through each other")
