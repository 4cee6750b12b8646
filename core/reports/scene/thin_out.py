"""Fewer faces to look at: vertices of one cell of a grid become their mean."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh

CELLS_PER_ROOT = 0.75  # a surface crosses about cells² cells of a grid with `cells` along its longest side
FINER = 0.8
MOST_TURNS = 8


@dataclass(frozen=True, eq=False, slots=True)
class Coarser:
    """A mesh for the eye. stands_for: (F,) the number of the face of the fine mesh that each of its faces was."""

    mesh: Mesh
    stands_for: NDArray[np.int64]


def thin_out(mesh: Mesh, wanted: int) -> Mesh:
    """About as many faces as wanted, for the eye alone: it may be open, fold and cut itself. Never none at all."""
    return make_coarser(mesh, wanted).mesh


def make_coarser(mesh: Mesh, wanted: int) -> Coarser:
    """The same, with what each face stands for: a value per face follows its face."""
    cells = np.sqrt(max(wanted, 1)) * CELLS_PER_ROOT
    result = Coarser(mesh, np.arange(len(mesh.faces), dtype=np.int64))
    for _ in range(MOST_TURNS):
        if len(result.mesh.faces) <= wanted:
            break
        coarser = _clustered(mesh, max(int(cells), 1))
        if coarser is None:
            break
        result = coarser
        cells *= FINER
    return result


def _clustered(mesh: Mesh, cells: int) -> Coarser | None:
    """None if no face is left."""
    low = mesh.vertices.min(axis=0)
    step = float(mesh.extents_mm().max()) / cells or 1.0
    places = np.floor((mesh.vertices - low) / step).astype(np.int64)
    codes = (places[:, 0] * (cells + 1) + places[:, 1]) * (cells + 1) + places[:, 2]
    _, cell, count = np.unique(codes, return_inverse=True, return_counts=True)
    means = np.column_stack([np.bincount(cell, mesh.vertices[:, axis], minlength=len(count)) / count for axis in range(3)])
    faces = cell[mesh.faces]
    kept = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    return Coarser(Mesh.of(means, faces[kept]), np.flatnonzero(kept)) if kept.any() else None
