"""Uploaded meshes."""

from __future__ import annotations

from pydantic import Field

from integument.answer import Answer
from integument.report import Finding


class Mesh(Answer):
    """A mesh the server holds; lengths in mm whatever the unit of the upload was."""

    id: str
    name: str = ""
    file_name: str = ""
    unit: str = ""
    format: str = ""
    size_bytes: int | None = None
    sha256: str | None = Field(None, description="Of the uploaded bytes")
    vertices: int | None = None
    faces: int | None = None
    extents_mm: tuple[float, float, float] | None = None
    findings: tuple[Finding, ...] = ()

    @property
    def href(self) -> str:
        """What a process input takes."""
        return f"/v1/meshes/{self.id}"
