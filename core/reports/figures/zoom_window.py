"""Where a section deserves a closer look: the stretch on which neighbouring shells come closest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.section import Contour
from core.reports.figures.levels import Level

Floats = NDArray[np.float64]
ZOOM_SPACINGS = 12.0  # width of the zoom in distances between the outermost and the innermost shell
SMALLEST_ZOOM, LARGEST_ZOOM = 0.06, 0.30  # shares of the window: never smaller; larger shows nothing new
SAMPLES_ACROSS = 800
MOST_SAMPLES = 10_000
MOST_CHAINS = 50  # the longest ones; a broken mesh can have thousands
SMOOTHING = 2.0  # a thin place is a stretch this many spacings to each side, not a single point


def zoom_window(contours: Mapping[str, Sequence[Contour]], level: Level) -> tuple[Floats, Floats] | None:
    """A square around the stretch where neighbouring shells are closest, measured against their usual distance here;
    None if there is one shell only, or if the whole section is as close up already."""
    sampled = [_resampled(chains, level) for chains in contours.values()]
    sampled = [points for points in sampled if len(points)]
    if len(sampled) < 2:
        return None
    places, ratios, spacings = [], [], []
    for outer, inner in pairwise(sampled):
        distances, _ = cKDTree(outer).query(inner)
        spacing = float(np.median(distances))
        places.append(inner)
        ratios.append(distances / max(spacing, 1e-9))
        spacings.append(spacing)
    window = float((level.high - level.low).max())
    if ZOOM_SPACINGS * sum(spacings) > LARGEST_ZOOM * window:
        return None
    points, ratio = np.concatenate(places), np.concatenate(ratios)
    pairs = cKDTree(points).query_pairs(SMOOTHING * sum(spacings) + window / SAMPLES_ACROSS, output_type="ndarray")
    ends, others = pairs.ravel(), pairs[:, ::-1].ravel()
    sums = ratio + np.bincount(ends, ratio[others], minlength=len(points))
    smoothed = sums / (1 + np.bincount(ends, minlength=len(points)))
    allowed = (points >= (level.low if level.zoom_from is None else level.zoom_from)).all(axis=1)
    centre = points[int(np.argmin(np.where(allowed | ~allowed.any(), smoothed, np.inf)))]
    width = max(ZOOM_SPACINGS * sum(spacings), SMALLEST_ZOOM * window)
    half = 0.5 * min(width, float((level.high - level.low).min()))
    centre = np.clip(centre, level.low + half, level.high - half)
    return centre - half, centre + half


def _resampled(chains: Sequence[Contour], level: Level) -> Floats:
    """Points at even distances on the contours, inside the window, (N, 2) mm."""
    spacing = float((level.high - level.low).max()) / SAMPLES_ACROSS
    pieces = [np.empty((0, 2))]
    for chain in chains[:MOST_CHAINS]:
        steps = np.linalg.norm(np.diff(chain.points, axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        places = np.linspace(0.0, along[-1], min(int(along[-1] / spacing) + 1, MOST_SAMPLES))
        pieces.append(np.column_stack([np.interp(places, along, chain.points[:, axis]) for axis in (0, 1)]))
    points = np.concatenate(pieces)
    inside = ((points >= level.low) & (points <= level.high)).all(axis=1)
    kept: Floats = points[inside]
    return kept
