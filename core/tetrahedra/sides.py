"""The faces of tetrahedra, each once, and the tetrahedra on both sides of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InternalError, LimitError

Ints = NDArray[np.int64]
SIDES = np.array([(1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1)])
NONE = -1
KEY_BITS = 21  # three fit into 64
MOST_VERTICES = 1 << KEY_BITS


@dataclass(frozen=True, eq=False, slots=True)
class Sides:
    """corners: (N, 3) vertex numbers, ascending, rows in order. first, second: (N,) tetrahedra; second NONE at the border."""

    corners: Ints
    first: Ints
    second: Ints


def sides(tetrahedra: NDArray[np.int32]) -> Sides:
    """All faces of tetrahedra (T, 4); O(T log T). Raises: InternalError `tetrahedra.not_proven` if three share a face."""
    corners = np.sort(tetrahedra.astype(np.int64)[:, SIDES].reshape(-1, 3), axis=1)
    order = np.argsort(face_keys(corners), kind="stable")
    corners, owner = corners[order], order // len(SIDES)
    starts = np.flatnonzero(np.append(True, (corners[1:] != corners[:-1]).any(axis=1)))
    count = np.diff(np.append(starts, len(corners)))
    if len(count) and count.max() > 2:
        raise InternalError("tetrahedra.not_proven", f"{int((count > 2).sum())} faces are shared by more than two tetrahedra")
    second = np.where(count == 2, owner[np.minimum(starts + 1, len(owner) - 1)], NONE)
    return Sides(corners[starts], owner[starts], second)


def face_keys(corners: Ints) -> Ints:
    """One number per row of ascending vertex numbers (N, 3), different for different rows, in their order.

    Raises: LimitError `tetrahedra.too_many_vertices`."""
    largest = int(corners.max(initial=0))
    if largest >= MOST_VERTICES:
        raise LimitError("tetrahedra.too_many_vertices", f"{largest + 1} vertices, at most {MOST_VERTICES} are possible")
    keys: Ints = (corners[:, 0] << 2 * KEY_BITS) | (corners[:, 1] << KEY_BITS) | corners[:, 2]
    return keys
