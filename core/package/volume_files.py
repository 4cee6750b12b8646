"""Tetrahedra as files: gmsh 2.2 binary as SimNIBS reads it, and VTU for ParaView; both through meshio."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import NDArray

from core.package.merged_surfaces import merge
from core.package.region_tag import SURFACE, region_tags
from core.package.tissue import Tissue
from core.tetrahedra.volume_mesh import VolumeMesh


def write_msh(path: Path, tissues: Sequence[Tissue], volume: VolumeMesh) -> None:
    """Triangles of all surfaces with tags 1000 + n, then tetrahedra with tag n, n the tissue's number; first order."""
    surfaces, tags = merge(tissues), _tags(tissues, volume)
    mesh = meshio.Mesh(
        volume.vertices,
        [("triangle", surfaces.faces), ("tetra", volume.tetrahedra.astype(np.int64))],
        cell_data={name: [surfaces.tags + SURFACE, tags] for name in ("gmsh:physical", "gmsh:geometrical")},
    )
    meshio.write(path, mesh, file_format="gmsh22", binary=True)


def write_vtu(path: Path, tissues: Sequence[Tissue], volume: VolumeMesh) -> None:
    """Tetrahedra with the tissue's number and its conductivity in S/m."""
    tags = _tags(tissues, volume)
    conductivity = np.array([tissue.conductivity_s_per_m for tissue in tissues])[volume.region]
    mesh = meshio.Mesh(
        volume.vertices,
        [("tetra", volume.tetrahedra.astype(np.int64))],
        cell_data={"region_tag": [tags], "conductivity_s_per_m": [conductivity]},
    )
    meshio.write(path, mesh, file_format="vtu", binary=True)


def _tags(tissues: Sequence[Tissue], volume: VolumeMesh) -> NDArray[np.int64]:
    tags = region_tags(tissues)
    return np.array([tags[tissue.name] for tissue in tissues], dtype=np.int64)[volume.region]
