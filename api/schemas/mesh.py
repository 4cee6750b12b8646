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


class MeshInfo(Document):
    """A mesh or a label volume this server holds. Lengths are in mm, whatever the unit of the file was."""

    id: str
    name: str
    file_name: str = Field(description="As sent")
    unit: Unit = Field(description="Of the file, as the uploader said")
    format: str = Field(description="stl, mat, ply, obj or, for a label volume, nifti, by content")
    size_bytes: int = Field(description="Of the file as sent")
    sha256: str = Field(description="Of the file as sent")
    vertices: int = Field(description="0 of a label volume")
    faces: int = Field(description="0 of a label volume")
    extents_mm: tuple[float, float, float]
    arrays: tuple[VertexArray, ...] = Field((), description="Numbers kept for each vertex, see `depth_array` of a layer")
    volume: VolumeInfo | None = Field(None, description="Of a label volume; absent for a mesh")
    findings: tuple[Finding, ...] = Field(description="What was noticed while reading: merged vertices, suspicious unit, ...")
    created: datetime
    links: tuple[Link, ...]


class MeshList(Document):
    """A page of meshes, newest first."""

    meshes: tuple[MeshInfo, ...]
    next: str | None = Field(None, description="Cursor of the next page; absent on the last")
    links: tuple[Link, ...]
