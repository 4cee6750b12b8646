"""The manifest of a package (`manifest.json`); every key is explained in docs/package.md."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from core.schema.model import FrozenModel
from core.schema.report import Verdict
from core.schema.shells import Side

FORMAT_VERSION = 1
FILE_NAME = "manifest.json"


class FileEntry(FrozenModel):
    """One file of the package."""

    sha256: str
    bytes: int


class TissueEntry(FrozenModel):
    """One tissue; the list is in nesting order, the outermost first."""

    name: str
    file: str = Field(description="Binary STL, path in the package")
    sha256: str = Field(description="Of `file`")
    mat_file: str = Field(description="MAT, path in the package")
    mat_sha256: str
    vertices: int
    faces: int
    depth_mm: float | None = Field(
        description="Distance to the skin asked for outside all regions, or their median if given by vertex; null for the skin"
    )
    side: Side | None = Field(None, description="`inside` or `outside` of the skin; null for the skin")
    conductivity_s_per_m: float = Field(description="Between this surface and the next ones inside")
    conductivity_source: str
    conductivity_frequency: str | None = Field(
        None, description="Frequencies a default stands for; null if the value was given, and in packages made before"
    )
    enclosing_tissue: str = Field(description="Name of a tissue listed before, or FreeSpace")
    region_tag: int | None = Field(
        None, description="The tissue's number in gmsh, NASTRAN and TetGen files; null in packages made before these"
    )


class Manifest(FrozenModel):
    """The whole manifest."""

    format_version: int = FORMAT_VERSION
    units: str = Field("mm", description="Of all coordinates")
    process: str
    verdict: Verdict
    tissues: tuple[TissueEntry, ...]
    notes: tuple[str, ...] = Field((), description="What a user should know before using the numbers")
    parameters: dict[str, Any] = Field(description="The inputs of the job, defaults filled in")
    input_sha256: dict[str, str] = Field(description="Input name -> checksum of the mesh the job started from")
    software: dict[str, str]
    files: dict[str, FileEntry] = Field(description="Every file of the package but this one")


def find_input_checksums(parameters: dict[str, Any]) -> dict[str, str]:
    """Input name -> sha256, from parameters in which an input is an object with a key `sha256`, at any depth."""
    found: dict[str, str] = {}
    for name, value in parameters.items():
        if isinstance(value, dict):
            checksum = value.get("sha256")
            found |= {name: checksum} if isinstance(checksum, str) else find_input_checksums(value)
    return found
