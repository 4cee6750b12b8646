"""The figures of a process that turns surfaces into surfaces: what was, what is, and the difference."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from core.geometry.body_frame import find_body_frame
from core.geometry.deviation import Deviation
from core.mesh import Mesh
from core.reports.figures.cross_sections import draw_cross_sections
from core.reports.figures.curvature_pair import draw_curvature_pair
from core.reports.figures.deviation_map import UNCHANGED_MM, draw_deviation_map
from core.reports.figures.figure import Figure
from core.reports.figures.gap_places import draw_gap_places
from core.reports.figures.levels import find_levels
from core.reports.figures.quality_pairs import draw_quality_pairs
from core.reports.figures.surface_views import draw_surface_views
from core.reports.palette import tissue_colours
from core.schema.report import Report
from core.validation.comparison import count_kept_vertices

MOSTLY_KEPT = 0.75  # share of vertices that came as they are: two pictures of the curvature would look the same
MOST_PAINTED = 6  # surfaces that get pictures of their own; a page of sixty-four would be read by nobody


def draw_comparison(originals: Mapping[str, Mesh], deviations: Mapping[str, Deviation], report: Report) -> tuple[Figure, ...]:
    """Curvature before and after where most is new, deviation, sections of a set, places of findings and gaps, quality.

    Needs:    originals and deviations of every mesh of the report. Nothing is asked of their shape.
    Promises: same input, same bytes; names are unique.
    """
    results = {name: deviations[name].back.surface for name in report.meshes}
    colours = tissue_colours(list(results))
    largest = max(results, key=lambda name: float(np.prod(results[name].extents_mm() + 1e-9)))
    frame = find_body_frame(results[largest])
    figures: list[Figure | None] = []
    changed = [name for name in results if deviations[name].maximum_mm > UNCHANGED_MM or _count(originals, results, name)]
    for name in changed[:MOST_PAINTED]:
        if count_kept_vertices(originals[name].vertices, results[name].vertices) < MOSTLY_KEPT * len(results[name].vertices):
            figures.append(draw_curvature_pair(name, originals[name], results[name], frame))
        if deviations[name].back.maximum_mm > UNCHANGED_MM:  # nothing was added or moved where pieces were taken away only
            figures.append(draw_deviation_map(name, deviations[name], frame))
    if any(finding.places for finding in report.findings):
        figures.append(draw_surface_views(results[largest], frame, colours[largest], report.findings))
    if len(results) > 1:
        levels = find_levels(results[largest], frame)
        figures += [draw_cross_sections(name, planes, results, colours) for name, planes in levels.items()]
        figures.append(draw_gap_places(report.pairs, results, colours))
    pairs = {name: (originals[name], result) for name, result in list(results.items())[:MOST_PAINTED]}
    figures.append(draw_quality_pairs(pairs, colours))
    return tuple(figure for figure in figures if figure is not None)


def _count(originals: Mapping[str, Mesh], results: Mapping[str, Mesh], name: str) -> int:
    """Faces more or less than before."""
    return len(results[name].faces) - len(originals[name].faces)
