"""Elements of gmsh files by type, and how many nodes each type has."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.io.msh_cursor import corrupt

Ints = NDArray[np.int64]
TRIANGLE, TETRAHEDRON = 2, 4
# gmsh's number of a type -> nodes; source: reference manual of gmsh, "MSH file format"
NODES_OF = dict(
    enumerate(
        (2, 3, 4, 4, 8, 6, 5, 3, 6, 9, 10, 27, 18, 14, 1, 8, 20, 15, 13, 9, 10, 12, 15, 15, 21, 4, 5, 6, 20, 35, 56), start=1
    )
)
FIRST_LOOK = 16


@dataclass(frozen=True, eq=False, slots=True)
class ElementRows:
    """Elements of one type: their numbers (N,) and the numbers of their nodes (N, nodes of the type)."""

    type: int
    ids: Ints
    nodes: Ints


def nodes_of(type_: int) -> int:
    """Nodes of an element. Raises: InputError `msh.corrupt`."""
    if type_ not in NODES_OF:
        raise corrupt(f"elements of type {type_} are not known")
    return NODES_OF[type_]


def count_alike(numbers: NDArray[np.generic], start: int, stride: int, columns: tuple[int, ...], most: int) -> int:
    """Rows of `stride` numbers from `start` on that have the same values in `columns` as the first; at most `most`, and no
    more than are there whole. Files have long runs of one type, so longer and longer pieces are looked at."""
    most = min(most, (len(numbers) - start) // stride)
    first = numbers[[start + column for column in columns]] if most > 0 else numbers[:0]
    known, step = min(most, 1), FIRST_LOOK
    while known < most:
        end = min(most, known + step)
        rows = numbers[start + known * stride : start + end * stride].reshape(-1, stride)
        differs = np.flatnonzero((rows[:, columns] != first).any(axis=1))
        if len(differs):
            return known + int(differs[0])
        known, step = end, 4 * step
    return known


def of_type(rows: Iterable[ElementRows], type_: int) -> ElementRows:
    """All elements of a type, in the order of the file."""
    alike = [each for each in rows if each.type == type_]
    none = ElementRows(type_, np.empty(0, np.int64), np.empty((0, nodes_of(type_)), np.int64))
    parts = alike or [none]
    return ElementRows(type_, np.concatenate([each.ids for each in parts]), np.concatenate([each.nodes for each in parts]))
