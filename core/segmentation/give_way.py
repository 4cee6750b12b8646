"""Neighbours kept apart: both give way by half of the gap, each towards its own voxels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.face_tree import FaceTree
from core.label_volume import LabelVolume
from core.mesh import Faces, Mesh
from core.run import RunContext
from core.segmentation.border import Border
from core.separation.contacts import find_contacts

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
Flags: TypeAlias = NDArray[np.bool_]

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
    surfaces = [_Yielding.of(border.mesh(volume)) for border in apart]
    for round_ in range(ROUNDS):
        missing = _find_missing(surfaces, gap_mm)
        if not any(each.any() for each in missing):
            return tuple(apart)
        run.log(f"round {round_ + 1}: {sum(int((each > 0).sum()) for each in missing):,} vertices give way once more")
        for number, lacking in enumerate(missing):
            if lacking.any():
                apart[number] = apart[number].with_share(apart[number].share - lacking / slopes[number], CLOSEST)
                surfaces[number] = surfaces[number].moved(apart[number].mesh(volume), lacking > 0.0)
            else:
                surfaces[number] = surfaces[number].at_rest()
    raise InputError(
        "segment.gap_not_reached",
        f"the surfaces cannot be brought {gap_mm:.4g} mm apart: too many labels meet within a few voxels; ask for a smaller gap",
        gap_mm=gap_mm,
    )


@dataclass(frozen=True, eq=False, slots=True)
class _Yielding:
    """A surface on its way. tree: of all its faces. asked: faces (K,) that may have come nearer to another surface since it was
    measured, or were too near then; part: a tree of these."""

    mesh: Mesh
    tree: FaceTree
    asked: Ints
    part: FaceTree | None

    @classmethod
    def of(cls, mesh: Mesh) -> _Yielding:
        """Before anything was measured."""
        tree = FaceTree.of(mesh.vertices, mesh.faces)
        return cls(mesh, tree, np.arange(len(mesh.faces)), tree)

    def moved(self, mesh: Mesh, vertices: Flags) -> _Yielding:
        """The flagged vertices (V,) went elsewhere."""
        asked = np.flatnonzero(vertices[mesh.faces].any(axis=1))
        part = FaceTree.of(mesh.vertices, mesh.faces[asked])
        return _Yielding(mesh, self.tree.moved(mesh.vertices, mesh.faces), asked, part)

    def at_rest(self) -> _Yielding:
        """None of them did."""
        return _Yielding(self.mesh, self.tree, self.asked[:0], None)


def _find_missing(surfaces: Sequence[_Yielding], gap_mm: float) -> list[Floats]:
    """By how many mm each vertex is to give way, (V,) for each surface: half of what its faces lack of the gap, and more."""
    missing = [np.zeros(len(each.mesh.vertices)) for each in surfaces]
    for a, b in combinations(range(len(surfaces)), 2):
        if _are_far(surfaces[a].mesh, surfaces[b].mesh, gap_mm):
            continue
        for first, second in ((a, b), (b, a)):
            asked, other = surfaces[first], surfaces[second]
            if asked.part is None:
                continue
            of_asked, of_other = find_contacts(asked.part, other.tree, gap_mm)
            _add(missing[first], asked.mesh.faces[asked.asked[of_asked.faces]], of_asked.distance_mm, gap_mm)
            _add(missing[second], other.mesh.faces[of_other.faces], of_other.distance_mm, gap_mm)
            if asked.part is asked.tree:
                break  # the other way round it is the same pairs
    return missing


def _add(missing: Floats, corners: Faces, distance_mm: Floats, gap_mm: float) -> None:
    """Raise what vertices (V,) miss to what these faces (K, 3) do."""
    lacking = (gap_mm - distance_mm) * MORE / 2 + LEAST * gap_mm
    np.maximum.at(missing, corners, lacking[:, None])


def _are_far(a: Mesh, b: Mesh, gap_mm: float) -> bool:
    """True if the boxes around two meshes are farther apart than the gap."""
    low = np.maximum(a.vertices.min(axis=0), b.vertices.min(axis=0))
    high = np.minimum(a.vertices.max(axis=0), b.vertices.max(axis=0))
    return bool((low - high > gap_mm).any())
