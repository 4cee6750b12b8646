"""Surfaces as files: written, read back, and found again in the package. What is proven is what the files hold."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from core.errors import InternalError
from core.io.registry import read_meshes, write_mesh
from core.mesh import Mesh
from core.package.read import read_shells


def write_and_read_back(surfaces: Mapping[str, Mesh], out_dir: Path) -> dict[str, Mesh]:
    """Each as binary STL under its name, read again."""
    delivered = {}
    for name, mesh in surfaces.items():
        path = out_dir / f"{name}.stl"
        write_mesh(mesh, path, "stl", name)
        delivered[name] = read_meshes(path, file_name=path.name, unit="mm").meshes[0].mesh
    return delivered


def require_unchanged(package: Path, delivered: Mapping[str, Mesh]) -> None:
    """The package must hold the very files that were proven. Raises: InternalError `package.differs`."""
    packed = read_shells(package)
    for name, mesh in delivered.items():
        if name not in packed or not np.array_equal(packed[name].triangles(), mesh.triangles()):
            raise InternalError("package.differs", f"the package does not hold the proven surface '{name}'", mesh=name)
