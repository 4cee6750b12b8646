"""Where a surface was changed: every place circled, in a colour for each kind of change."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from core.geometry.body_frame import find_body_frame
from core.mesh import Mesh
from core.reports.figures.circled_views import Mark, draw_circled
from core.reports.figures.figure import Figure
from core.reports.palette import OTHER_COLOURS, as_hex, tissue_colours

MOST_PLACES = 100  # of one kind; circles around thousands hide the surface


def draw_change_places(meshes: Mapping[str, Mesh], changes: Sequence[Mapping[str, Any]]) -> tuple[Figure, ...]:
    """A picture for every mesh that has changes with places.

    changes: facts with `mesh`, `kind`, `count` and `places` [{point_mm, distance_mm}], the farthest first; others do not count.
    """
    colours = tissue_colours(list(meshes))
    figures = []
    for name, mesh in meshes.items():
        marks = _marks([change for change in changes if change.get("mesh") == name and change.get("places")])
        if not marks:
            continue
        png = draw_circled(mesh, find_body_frame(mesh), colours[name], marks)
        words = "; ".join(f"{mark.label} at {mark.count} place{'' if mark.count == 1 else 's'}" for mark in marks)
        caption = (
            f"What was changed on {name}, circled on the result: {words}. "
            "Numbers: several close together; dashed: no view shows them."
        )
        figures.append(Figure(f"changes_{name}", f"Changes: {name}", caption, png))
    return tuple(figures)


def _marks(changes: Sequence[Mapping[str, Any]]) -> list[Mark]:
    by_kind: dict[str, list[Mapping[str, Any]]] = {}
    for change in changes:
        by_kind.setdefault(str(change.get("kind", "change")), []).append(change)
    marks = []
    for number, (kind, alike) in enumerate(by_kind.items()):
        points = [place["point_mm"] for change in alike for place in change["places"]][:MOST_PLACES]
        count = sum(int(change.get("count", len(change["places"]))) for change in alike)
        colour = as_hex(OTHER_COLOURS[number % len(OTHER_COLOURS)])
        marks.append(Mark(kind.replace("_", " "), colour, count, np.array(points, dtype=np.float64)))
    return marks
