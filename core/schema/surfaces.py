"""What a process works on: one surface, several by name, or a package."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from core.schema.conductivities import ConductivityInputs
from core.schema.model import FrozenModel
from core.schema.reference import MeshReference, PackageReference
from core.schema.validate import MeshName

# outputs of the process itself, and BEM-FMM's word for air
RESERVED_NAMES = ("package", "report", "report_html", "FreeSpace")


class SurfaceSubject(FrozenModel):
    """Exactly one of `mesh`, `meshes` and `package`."""

    subjects: ClassVar[tuple[str, ...]] = ("mesh", "meshes", "package")

    mesh: MeshReference | None = Field(None, description="One surface")
    meshes: Annotated[dict[MeshName, MeshReference], Field(min_length=1, max_length=64)] | None = Field(
        None, description="Surfaces by name, treated together"
    )
    package: PackageReference | None = Field(
        None, description="The package of an earlier job: all its surfaces, treated together"
    )

    @model_validator(mode="after")
    def _one_subject(self) -> SurfaceSubject:
        given = [name for name in self.subjects if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"exactly one of {', '.join(self.subjects)} is wanted, got {', '.join(given) or 'none'}")
        # names become outputs and files, and some file systems do not tell cases apart
        names = list(self.meshes or ())
        if len({name.lower() for name in (*names, *RESERVED_NAMES)}) != len(names) + len(RESERVED_NAMES):
            raise ValueError(f"names must differ from each other and from {', '.join(RESERVED_NAMES)}: {names}")
        return self


class SurfacesInputs(ConductivityInputs, SurfaceSubject):
    """Several surfaces are treated together and stay apart."""

    min_gap_mm: float = Field(0.05, gt=0, le=10, description="Smallest distance allowed between two surfaces treated together")
