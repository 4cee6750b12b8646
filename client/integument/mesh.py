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


class FieldDataInfo(Answer):
    """One quantity in a gmsh file: at its `nodes` or in its `elements`."""

    name: str
    where: str = ""
    components: int = 1


class FieldInfo(Answer):
    """What there is in a field."""

    rows: int = 0
    columns: tuple[str, ...] = ()
    nodes: int = 0
    triangles: int = 0
    tetrahedra: int = 0
    data: tuple[FieldDataInfo, ...] = ()


class CoilInfo(Answer):
    """What there is in a coil."""

    dipoles: int = 0
    wire_pieces: int = 0


class Mesh(Answer):
    """A mesh, label volume, field or coil the server holds; lengths in mm whatever the unit of the upload was."""

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
    volume: VolumeInfo | None = Field(None, description="Of a label volume; None of all else")
    field: FieldInfo | None = Field(None, description="Of a field; None of all else")
    coil: CoilInfo | None = Field(None, description="Of a coil; None of all else")
    findings: tuple[Finding, ...] = ()

    @property
    def href(self) -> str:
        """What a process input takes."""
        return f"/v1/meshes/{self.id}"
