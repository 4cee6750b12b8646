"""VTU for ParaView. Written only, through meshio."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from core.mesh import Mesh


def write(mesh: Mesh, path: Path, name: str) -> None:
    """Triangles with float64 coordinates in mm; the format has no place for a name."""
    del name
    meshio.write(path, meshio.Mesh(mesh.vertices, [("triangle", mesh.faces.astype(np.int64))]), file_format="vtu", binary=True)
