"""Ears, as they are found."""

from __future__ import annotations

from pydantic import Field

from api.schemas.document import Document
from core.schema.shells import Box


class FoundEar(Document):
    """One ear; fits into the input `ears` of the process of that name."""

    name: str = Field(description="`left_ear` or `right_ear`, from the body's own view")
    box_mm: Box


class FoundEars(Document):
    """Both ears of a whole body."""

    ears: tuple[FoundEar, ...]
