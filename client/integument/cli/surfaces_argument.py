"""Surfaces as they are typed: one mesh, several, or a package; held by the server or on this disk."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from integument.cli.mesh_argument import is_held, name_meshes, require_mesh
from integument.cli.mesh_reference import refer_to
from integument.cli.progress import ProgressView
from integument.cli.session import Session
from integument.errors import ArgumentError
from integument.local_package import unpack_surfaces
from integument.surface_processes import Unit

PACKAGE = "package"


@dataclass(frozen=True, slots=True)
class Surfaces:
    """One of: a mesh, a package the server holds, meshes by name, or the zip of a package on this disk."""

    mesh: str | None = None
    package: str | None = None
    meshes: Mapping[str, str] = field(default_factory=dict)
    zip_path: Path | None = None

    @property
    def output(self) -> str:
        """The output that holds what is made of them."""
        return "mesh" if self.mesh is not None else PACKAGE


def read_surfaces(texts: list[str]) -> Surfaces:
    """Raises: ArgumentError before anything is started or sent."""
    packages = [text for text in texts if _is_package(text)]
    if packages and len(texts) > 1:
        raise ArgumentError(f"{packages[0]}: a package is treated alone, not with {len(texts) - 1} other meshes")
    if packages:
        (text,) = packages
        return Surfaces(package=text) if is_held(text) else Surfaces(zip_path=Path(require_mesh(text)))
    meshes = [require_mesh(text) for text in texts]
    return Surfaces(mesh=meshes[0]) if len(meshes) == 1 else Surfaces(meshes=name_meshes(meshes))


def refer_to_surfaces(session: Session, view: ProgressView, surfaces: Surfaces, unit: Unit) -> dict[str, Any]:
    """The inputs that name them; files are uploaded, with progress.

    The surfaces of a zip keep their names; its depths and conductivities stay behind, since the server reads meshes only.
    """
    if surfaces.package is not None:
        return {PACKAGE: {"href": surfaces.package}}
    if surfaces.mesh is not None:
        return {"mesh": refer_to(session, view, surfaces.mesh, unit)}
    if surfaces.zip_path is not None:
        with TemporaryDirectory(prefix="integument-") as folder:
            unpacked = unpack_surfaces(surfaces.zip_path, Path(folder))
            return {"meshes": {name: refer_to(session, view, str(path), "mm") for name, path in unpacked.items()}}
    return {"meshes": {name: refer_to(session, view, mesh, unit) for name, mesh in surfaces.meshes.items()}}


def _is_package(text: str) -> bool:
    return text.endswith(f"/results/{PACKAGE}") if is_held(text) else Path(text).suffix.lower() == ".zip"
