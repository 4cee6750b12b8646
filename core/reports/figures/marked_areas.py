"""Parts of a surface that findings are about, painted, with the places they name circled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.body_frame import BodyFrame
from core.geometry.normals import face_areas
from core.mesh import Mesh
from core.reports.figures.circled_views import Mark, draw_circled
from core.reports.figures.figure import Figure
from core.reports.palette import Colour, as_hex, lightened
from core.schema.finding import Finding

LIMITED: Colour = (31, 111, 178)
MISSED: Colour = (184, 110, 0)
MOVED: Colour = (120, 60, 150)
PALE, PAINTED = 0.78, 0.3  # the mesh, and the areas on it: a circle in the area's own colour shows on both


@dataclass(frozen=True, eq=False, slots=True)
class MarkedArea:
    """What findings of one code are about: `vertices` (V,) flags on the mesh they name, `words` for the caption."""

    code: str
    words: str
    colour: Colour
    vertices: NDArray[np.bool_]


def draw_marked_areas(
    name: str, mesh: Mesh, frame: BodyFrame, colour: Colour, areas: Sequence[MarkedArea], findings: Sequence[Finding]
) -> Figure | None:
    """A face is painted if a corner of it is marked, by the last area that has it; None if nothing is marked."""
    paint = np.tile(np.array(lightened(colour, PALE), dtype=np.uint8), (len(mesh.faces), 1))
    sizes = face_areas(mesh.vertices, mesh.faces)
    marks, words = [], []
    for area in areas:
        if not area.vertices.any():
            continue
        faces = area.vertices[mesh.faces].any(axis=1)
        paint[faces] = lightened(area.colour, PAINTED)
        alike = [finding for finding in findings if finding.code == area.code and _is_on(finding, name)]
        points = [place.point_mm for finding in alike for place in finding.places]
        count = sum(finding.count for finding in alike)
        marks.append(Mark(area.words, as_hex(area.colour), count, np.array(points, dtype=np.float64).reshape(-1, 3)))
        share = 100 * float(sizes[faces].sum() / sizes.sum())
        words.append(f"{area.words}: {count} place{'' if count == 1 else 's'}, {share:.2g} % of the area with the faces around")
    if not marks:
        return None
    png = draw_circled(mesh, frame, colour, marks, paint)
    what = "; ".join(words)
    caption = f"{name}, painted and circled where it is {what}. Numbers: several close together; dashed: no view shows them."
    return Figure(f"places_{name}", f"Places: {name}", caption, png)


def _is_on(finding: Finding, name: str) -> bool:
    return any(place.mesh == name for place in finding.places)
