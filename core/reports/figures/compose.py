"""Which figures a report gets, in the order of the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from core.geometry.body_frame import find_body_frame
from core.mesh import Mesh
from core.reports.figures.cross_sections import draw_cross_sections
from core.reports.figures.figure import Figure
from core.reports.figures.gap_places import draw_gap_places
from core.reports.figures.levels import find_levels
from core.reports.figures.marked_areas import MarkedArea, draw_marked_areas
from core.reports.figures.quality_histogram import draw_quality_histogram
from core.reports.figures.surface_views import draw_surface_views
from core.reports.figures.thickness_histogram import draw_thickness_histogram
from core.reports.figures.thickness_map import draw_thickness_map
from core.reports.palette import tissue_colours
from core.schema.finding import Finding
from core.schema.report import PairReport

Floats = NDArray[np.float64]
NO_AREAS: Mapping[str, Sequence[MarkedArea]] = {}


class DrawnTissue(Protocol):
    """What a figure needs of a tissue; `core.package.tissue.Tissue` fits."""

    @property
    def name(self) -> str:
        """Unique name."""
        ...

    @property
    def mesh(self) -> Mesh:
        """Its outer surface, mm."""
        ...

    @property
    def depth_mm(self) -> float | None:
        """Distance to the skin asked for outside all regions; None for the skin."""
        ...


def draw_shell_figures(
    tissues: Sequence[DrawnTissue],
    depths_mm: Mapping[str, Floats],
    *,
    pairs: Sequence[PairReport] = (),
    findings: Sequence[Finding] = (),
    areas: Mapping[str, Sequence[MarkedArea]] = NO_AREAS,
) -> tuple[Figure, ...]:
    """All figures of nested shells.

    Needs:    tissues in nesting order, the outermost first; depths_mm: layer -> measured distance to the skin, (F,) or (V,) of
              the layer's mesh; layers without depths get no thickness figures. areas: tissue -> what findings are about.
    Promises: same input, same bytes; names are unique.
    """
    meshes = {tissue.name: tissue.mesh for tissue in tissues}
    colours = tissue_colours(list(meshes))
    outermost = tissues[0].mesh
    frame = find_body_frame(outermost)
    targets = {tissue.name: tissue.depth_mm for tissue in tissues if tissue.depth_mm is not None and tissue.name in depths_mm}
    measured = {name: depths_mm[name] for name in targets}
    figures: list[Figure | None] = [
        draw_cross_sections(name, levels, meshes, colours) for name, levels in find_levels(outermost, frame).items()
    ]
    figures += [draw_thickness_map(name, meshes[name], measured[name], target, frame) for name, target in targets.items()]
    figures.append(draw_thickness_histogram(meshes, measured, targets, colours) if measured else None)
    figures += [draw_marked_areas(name, meshes[name], frame, colours[name], marked, findings) for name, marked in areas.items()]
    painted = {area.code for marked in areas.values() for area in marked}
    others = [finding for finding in findings if finding.places and finding.code not in painted]
    if others:
        figures.append(draw_surface_views(outermost, frame, colours[tissues[0].name], others))
    figures += [draw_gap_places(pairs, meshes, colours), draw_quality_histogram(meshes, colours)]
    return tuple(figure for figure in figures if figure is not None)


def draw_mesh_figures(
    meshes: Mapping[str, Mesh], *, pairs: Sequence[PairReport] = (), findings: Sequence[Finding] = ()
) -> tuple[Figure, ...]:
    """All figures of a set of meshes that need not nest, close or be good in any way.

    Needs:    meshes in any order, the largest one gives the views and sections their frame.
    Promises: same input, same bytes; names are unique.
    """
    ordered = dict(sorted(meshes.items(), key=lambda item: -float(np.prod(item[1].extents_mm() + 1e-9))))
    colours = tissue_colours(list(meshes))
    outermost = next(iter(ordered.values()))
    frame = find_body_frame(outermost)
    figures: list[Figure | None] = [
        draw_surface_views(outermost, frame, colours[next(iter(ordered))], findings),
        *(draw_cross_sections(name, levels, ordered, colours) for name, levels in find_levels(outermost, frame).items()),
        draw_gap_places(pairs, ordered, colours),
        draw_quality_histogram(ordered, colours),
    ]
    return tuple(figure for figure in figures if figure is not None)
