"""Uploaded meshes."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import Field

from api.schemas.document import Document
from api.schemas.link import Link
from core.schema.finding import Finding

Unit = Literal["m", "cm", "mm", "in"]


class VertexArray(Document):
    """Numbers of a MAT file, one per vertex, that a layer may name as its depths; in mm if they are that."""

    name: str
    minimum: float | None = Field(None, description="Of the finite values; absent if there is none")
    maximum: float | None = None
    not_finite: int = Field(description="How many values are NaN or infinite")


class LabelInfo(Document):
    """One label of a volume."""

    label: int
    voxels: int
    volume_mm3: float


class VolumeInfo(Document):
    """Voxels and labels of a label volume."""

    voxels: tuple[int, int, int] = Field(description="Along the three axes of the file")
    voxel_mm: tuple[float, float, float] = Field(description="Distances between the centres of neighbouring voxels")
    affine: tuple[tuple[float, float, float, float], ...] = Field(
        description="Four rows: from the number of a voxel (i, j, k, 1) to its centre (x, y, z, 1) in mm"
    )
    labels: tuple[LabelInfo, ...] = Field(description="Ascending, without 0")
    expected_faces: int = Field(description="About how many faces the first surfaces of all labels have; jobs are sized by it")


class FieldDataInfo(Document):
    """One quantity in a gmsh file."""

    name: str
    where: Literal["nodes", "elements"]
    components: int = Field(description="1 or 3")


class FieldInfo(Document):
    """What there is in a field: rows and columns of a matrix of text, or a mesh with data."""

    rows: int = Field(description="Of a matrix; 0 of a gmsh file")
    columns: tuple[str, ...] = Field(description="Names of the header from left to right, empty where there is none")
    nodes: int
    triangles: int
    tetrahedra: int
    data: tuple[FieldDataInfo, ...]
    numbers: int = Field(description="How many numbers it has; jobs are sized by it")


class CoilInfo(Document):
    """What there is in a coil."""

    dipoles: int
    wire_pieces: int


class MeshInfo(Document):
    """A mesh, label volume, field or coil this server holds. Lengths are in mm, whatever the unit of the file was."""

    id: str
    name: str
    file_name: str = Field(description="As sent")
    unit: Unit = Field(description="Of the file, as the uploader said")
    format: str = Field(
        description="By content: stl, mat, ply, obj; nifti or mgh of labels; msh or table of a field; ccd or tcd of a coil"
    )
    size_bytes: int = Field(description="Of the file as sent")
    sha256: str = Field(description="Of the file as sent")
    vertices: int = Field(description="0 of what is no mesh")
    faces: int = Field(description="0 of what is no mesh")
    extents_mm: tuple[float, float, float]
    arrays: tuple[VertexArray, ...] = Field((), description="Numbers kept for each vertex, see `depth_array` of a layer")
    volume: VolumeInfo | None = Field(None, description="Of a label volume; absent for all else")
    field: FieldInfo | None = Field(None, description="Of a field; absent for all else")
    coil: CoilInfo | None = Field(None, description="Of a coil; absent for all else")
    findings: tuple[Finding, ...] = Field(description="What was noticed while reading: merged vertices, suspicious unit, ...")
    created: datetime
    links: tuple[Link, ...]


class MeshList(Document):
    """A page of meshes, newest first."""

    meshes: tuple[MeshInfo, ...]
    next: str | None = Field(None, description="Cursor of the next page; absent on the last")
    links: tuple[Link, ...]
