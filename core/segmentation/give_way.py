"""Neighbours kept apart: both give way by half of the gap, each towards its own voxels."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.distance import closest_points_in, smallest_gap_between
from core.geometry.face_tree import FaceTree
from core.label_volume import LabelVolume
from core.mesh import Mesh
from core.run import RunContext
from core.segmentation.border import Border

Floats: TypeAlias = NDArray[np.float64]

MORE = 1.2  # both give way by this more than half of the gap: on a curved border edges are chords
CLOSEST = 0.02  # share of an edge that stays between a surface that gave way and its voxel
ROUNDS = 40
NEARLY = 1.1  # faces are looked at beyond their corners where a corner is nearer than this times what is asked
FARTHER = 0.1  # of the gap, what counts as near grows by this from round to round: sides may be nearer than any place looked at


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
        crowded = [border.crowded for border in apart]
        missing = _find_missing(meshes, crowded, gap_mm, gap_mm * (1.0 + FARTHER * round_))
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


def _find_missing(meshes: Sequence[Mesh], crowded: Sequence[NDArray[np.bool_]], gap_mm: float, reach_mm: float) -> list[Floats]:
    """By how much each vertex is to give way to be `reach_mm` away, (V,) mm for each mesh; 0 where a pair is `gap_mm` apart."""
    missing = [np.zeros(len(mesh.vertices)) for mesh in meshes]
    trees = [FaceTree.of(mesh.vertices, mesh.faces) for mesh in meshes]
    for (i, a), (j, b) in combinations(enumerate(meshes), 2):
        if _are_far(a, b, gap_mm):
            continue
        gap = smallest_gap_between(trees[i], trees[j])
        if gap.distance_mm >= gap_mm:
            continue
        # where faces are too near without any corner being so
        least = (gap_mm - gap.distance_mm) * MORE / 2 + 0.02 * gap_mm
        missing[i][a.faces[gap.face_a]] = np.maximum(missing[i][a.faces[gap.face_a]], least)
        missing[j][b.faces[gap.face_b]] = np.maximum(missing[j][b.faces[gap.face_b]], least)
        for mine, other, first, second in ((i, j, a, b), (j, i, b, a)):
            near = np.flatnonzero(crowded[mine] & _within(first.vertices, second, reach_mm))
            asked, corners = first.vertices[near], np.column_stack((near, near, near))
            for beyond_corners in (False, True):
                distance, _place, face = closest_points_in(trees[other], asked)
                lacking = np.where(distance < reach_mm, (reach_mm - distance) * MORE / 2, 0.0)
                np.maximum.at(missing[mine], corners, lacking[:, None])
                np.maximum.at(missing[other], second.faces[face], lacking[:, None])
                if not beyond_corners:
                    asked, corners = _samples(first, near[distance < NEARLY * reach_mm])
    return missing


def _samples(mesh: Mesh, near: NDArray[np.int64]) -> tuple[Floats, NDArray[np.int64]]:
    """Places (N, 3) on the faces at some vertices, and the corners (N, 3) that move each: middles of sides, centres."""
    flag = np.zeros(len(mesh.vertices), dtype=np.bool_)
    flag[near] = True
    faces = mesh.faces[flag[mesh.faces].any(axis=1)]
    triangles = mesh.vertices[faces]
    places = np.concatenate(((triangles + np.roll(triangles, 1, axis=1)).reshape(-1, 3) / 2, triangles.mean(axis=1)))
    sides = np.stack((faces, np.roll(faces, 1, axis=1), faces), axis=-1).reshape(-1, 3)
    return places, np.concatenate((sides, faces)).astype(np.int64)


def _within(points: Floats, mesh: Mesh, gap_mm: float) -> NDArray[np.bool_]:
    """Points (N, 3) in the box around a mesh and the gap."""
    low, high = mesh.vertices.min(axis=0) - gap_mm, mesh.vertices.max(axis=0) + gap_mm
    inside: NDArray[np.bool_] = ((points >= low) & (points <= high)).all(axis=1)
    return inside


def _are_far(a: Mesh, b: Mesh, gap_mm: float) -> bool:
    """True if the boxes around two meshes are farther apart than the gap."""
    low = np.maximum(a.vertices.min(axis=0), b.vertices.min(axis=0))
    high = np.minimum(a.vertices.max(axis=0), b.vertices.max(axis=0))
    return bool((low - high > gap_mm).any())
