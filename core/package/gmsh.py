"""All surfaces in one gmsh 2.2 binary file, as SimNIBS reads it, through meshio."""

from __future__ import annotations

from pathlib import Path

import meshio

from core.package.merged_surfaces import MergedSurfaces
from core.package.region_tag import SURFACE

FILE = "gmsh/surfaces.msh"
VOLUME_FILE = "gmsh/volume.msh"  # see `volume_files.write_msh`


def write_surfaces(path: Path, surfaces: MergedSurfaces) -> None:
    """First-order triangles; both tags of each are 1000 + the tissue's number, as SimNIBS has it."""
    tags = surfaces.tags + SURFACE
    mesh = meshio.Mesh(
        surfaces.vertices,
        [("triangle", surfaces.faces)],
        cell_data={"gmsh:physical": [tags], "gmsh:geometrical": [tags]},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=True)
