"""A field on surfaces for the eye: fewer triangles, each with the value of one that was there."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from core.mesh import Mesh
from core.package.field_files import SIMNIBS_MAGNITUDE, write_triangles
from core.reports.scene.thin_out import make_coarser


def write_preview(source: Path, target: Path, most_faces: int) -> None:
    """What `write_msh` wrote at `source`, with about `most_faces` triangles of all surfaces together at most.

    A triangle keeps its tag and the magnitude of the one it stands for: no value is mixed or made up. E is left out. Never none
    of a surface."""
    read = meshio.read(source, file_format="gmsh")
    [block], [tags], [magnitudes] = read.cells, read.cell_data["gmsh:physical"], read.cell_data[SIMNIBS_MAGNITUDE]
    share = most_faces / len(tags)
    vertices, faces, stands_for, start = [], [], [], 0
    for tag in dict.fromkeys(tags.tolist()):  # in the order of the file
        rows = np.flatnonzero(tags == tag)
        used, corners = np.unique(block.data[rows], return_inverse=True)
        coarser = make_coarser(Mesh.of(read.points[used], corners.reshape(-1, 3)), int(share * len(rows)))
        vertices.append(coarser.mesh.vertices)
        faces.append(coarser.mesh.faces.astype(np.int64) + start)
        stands_for.append(rows[coarser.stands_for])
        start += len(coarser.mesh.vertices)
    kept = np.concatenate(stands_for)
    write_triangles(target, np.vstack(vertices), np.vstack(faces), tags[kept], {SIMNIBS_MAGNITUDE: magnitudes[kept]})
