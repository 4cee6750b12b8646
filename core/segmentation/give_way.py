"""Neighbours kept apart: both give way by half of the gap, each towards its own voxels."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.face_tree import FaceTree
from core.label_volume import LabelVolume
from core.mesh import Mesh
from core.run import RunContext
from core.segmentation.border import Border
from core.separation.contacts import find_contacts

Floats: TypeAlias = NDArray[np.float64]

MORE = 1.1  # both give way by this more than half of the gap: on a curved border edges are chords
CLOSEST = 0.02  # share of an edge that stays between a surface that gave way and its voxel
ROUNDS = 40
LEAST = 0.02  # of the gap: no step is smaller


def give_way(volume: LabelVolume, borders: Sequence[Border], gap_mm: float, run: RunContext) -> tuple[Border, ...]:
    """Borders whose surfaces, as rounded, are `gap_mm` apart or more.

    Raises: InputError `segment.gap_not_reached` if labels are mixed so finely that there is no room.
    """
    apart = list(borders)
    slopes = [border.slopes(volume) for border in borders]
    for number, border in enumerate(borders):
        step = np.where(border.crowded, MORE * gap_mm / 2 / slopes[number], 0.0)
        apart[number] = border.with_share(border.share - step, CLOSEST)
    for round_ in range(ROUNDS):
        meshes = [border.mesh(volume) for border in apart]
        missing = _find_missing(meshes, gap_mm)
        if not any(each.any() for each in missing):
            return tuple(apart)
        run.log(f"round {round_ + 1}: {sum(int((each > 0).sum()) for each in missing):,} vertices give way once more")
        for number, (border, lacking) in enumerate(zip(apart, missing, strict=True)):
            if lacking.any():
                apart[number] = border.with_share(border.share - lacking / slopes[number], CLOSEST)
    raise InputError(
        "segment.gap_not_reached",
        f"the surfaces cannot be brought {gap_mm:.4g} mm apart: too many labels meet within a few voxels; ask for a smaller gap",
        gap_mm=gap_mm,
    )


def _find_missing(meshes: Sequence[Mesh], gap_mm: float) -> list[Floats]:
    """By how much each vertex is to give way, (V,) mm for each mesh: half of what the faces at it lack of the gap, and more."""
    missing = [np.zeros(len(mesh.vertices)) for mesh in meshes]
    trees = [FaceTree.of(mesh.vertices, mesh.faces) for mesh in meshes]
    for (i, a), (j, b) in combinations(enumerate(meshes), 2):
        if _are_far(a, b, gap_mm):
            continue
        for number, mesh, contacts in zip((i, j), (a, b), find_contacts(trees[i], trees[j], gap_mm), strict=True):
            lacking = (gap_mm - contacts.distance_mm) * MORE / 2 + LEAST * gap_mm
            np.maximum.at(missing[number], mesh.faces[contacts.faces], lacking[:, None])
    return missing


def _are_far(a: Mesh, b: Mesh, gap_mm: float) -> bool:
    """True if the boxes around two meshes are farther apart than the gap."""
    low = np.maximum(a.vertices.min(axis=0), b.vertices.min(axis=0))
    high = np.minimum(a.vertices.max(axis=0), b.vertices.max(axis=0))
    return bool((low - high > gap_mm).any())
