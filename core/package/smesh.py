"""TetGen's `.smesh`: all surfaces, and a point in each piece of a tissue that gives its tetrahedra their number."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.geometry.point_within import find_points_within
from core.package.merged_surfaces import merge
from core.package.region_tag import region_tags
from core.package.tissue import Tissue

FILE = "tetgen/surfaces.smesh"


def smesh_text(tissues: Sequence[Tissue], gap_mm: float) -> str:
    """The whole file; `tetgen -pA surfaces.smesh` fills it. gap_mm: no surface comes nearer to another than this."""
    merged = merge(tissues)
    tags = region_tags(tissues)
    count, vertices = len(merged.vertices), merged.vertices
    nodes = ("%d %.9g %.9g %.9g\n" * count) % tuple(np.column_stack([np.arange(count), vertices]).ravel().tolist())
    facets = np.column_stack([np.full(len(merged.faces), 3), merged.faces, merged.tags])
    rows = ("%d %d %d %d %d\n" * len(facets)) % tuple(facets.ravel().tolist())
    points = [(tags[tissue.name], point) for tissue in tissues for point in find_points_within(tissue.mesh, gap_mm)[0]]
    regions = [f"{number} {x:.9g} {y:.9g} {z:.9g} {tag}" for number, (tag, (x, y, z)) in enumerate(points)]
    head = "# mm; the mark of a facet and of a region is the tissue's number in manifest.json\n"
    return f"{head}{count} 3 0 0\n{nodes}{len(facets)} 1\n{rows}0\n{len(regions)}\n" + "".join(f"{row}\n" for row in regions)
