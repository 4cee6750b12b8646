"""Uploaded meshes."""

from __future__ import annotations

from pydantic import Field

from integument.answer import Answer
from integument.report import Finding


class VertexArray(Answer):
    """Numbers of a MAT file, one per vertex, that a layer may name as its depths."""

    name: str
    minimum: float | None = None
    maximum: float | None = None
    not_finite: int = 0


class LabelInfo(Answer):
    """One label of a volume."""

    label: int
    voxels: int = 0
    volume_mm3: float = 0.0


class VolumeInfo(Answer):
    """Voxels and labels of a label volume."""

    voxels: tuple[int, int, int]
    voxel_mm: tuple[float, float, float] | None = None
    labels: tuple[LabelInfo, ...] = ()


class Mesh(Answer):
    """A mesh or a label volume the server holds; lengths in mm whatever the unit of the upload was."""

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
    arrays: tuple[VertexArray, ...] = ()
    volume: VolumeInfo | None = Field(None, description="Of a label volume; None of a mesh")
    findings: tuple[Finding, ...] = ()

    @property
    def href(self) -> str:
        """What a process input takes."""
        return f"/v1/meshes/{self.id}"
