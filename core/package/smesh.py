"""TetGen's `.smesh`: all surfaces, and a point in each tissue that gives its tetrahedra their number."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.geometry.containment import is_inside
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas, face_normals
from core.package.merged_surfaces import merge
from core.package.region_tag import region_tags
from core.package.tissue import Tissue

FILE = "tetgen/surfaces.smesh"
CANDIDATES = 64  # largest faces tried for a point below them


def smesh_text(tissues: Sequence[Tissue], gap_mm: float) -> str:
    """The whole file; `tetgen -pA surfaces.smesh` fills it. gap_mm: no surface comes nearer to another than this."""
    merged = merge(tissues)
    tags = region_tags(tissues)
    count, vertices = len(merged.vertices), merged.vertices
    nodes = ("%d %.9g %.9g %.9g\n" * count) % tuple(np.column_stack([np.arange(count), vertices]).ravel().tolist())
    facets = np.column_stack([np.full(len(merged.faces), 3), merged.faces, merged.tags])
    rows = ("%d %d %d %d %d\n" * len(facets)) % tuple(facets.ravel().tolist())
    points = [(tags[tissue.name], find_point_within(tissue, gap_mm)) for tissue in tissues]
    regions = [
        f"{number} {point[0]:.9g} {point[1]:.9g} {point[2]:.9g} {tag}"
        for number, (tag, point) in enumerate((tag, point) for tag, point in points if point is not None)
    ]
    head = "# mm; the mark of a facet and of a region is the tissue's number in manifest.json\n"
    return f"{head}{count} 3 0 0\n{nodes}{len(facets)} 1\n{rows}0\n{len(regions)}\n" + "".join(f"{row}\n" for row in regions)


def find_point_within(tissue: Tissue, gap_mm: float) -> NDArray[np.float64] | None:
    """A point (3,) mm between this surface and those inside it: a quarter of the gap below the middle of a large face.

    Nearer to this surface than any other comes, so outside of all that lies inside it. None if the surface is so thin that
    none of its largest faces has room below it.
    """
    mesh = tissue.mesh
    largest = np.argsort(-face_areas(mesh.vertices, mesh.faces), kind="stable")[:CANDIDATES]
    faces = mesh.faces[largest]
    points = mesh.vertices[faces].mean(axis=1) - 0.25 * gap_mm * face_normals(mesh.vertices, faces)
    inside = np.flatnonzero(is_inside(FaceTree.of(mesh.vertices, mesh.faces), points))
    return points[inside[0]] if len(inside) else None
