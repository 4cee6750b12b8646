"""The faces around a vertex, walked by opposite corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.decimation.kernel import kernel

Ints = NDArray[np.int64]
Int32s = NDArray[np.int32]


@kernel
def following(corner: int) -> int:
    """The next corner of the same face."""
    turned: int = corner - 2 if corner % 3 == 2 else corner + 1
    return turned


@kernel
def preceding(corner: int) -> int:
    """The corner before in the same face."""
    turned: int = corner + 2 if corner % 3 == 0 else corner - 1
    return turned


@kernel
def gather_star(opposite: Int32s, corner: int, star: Ints) -> int:
    """The corners at one vertex, in turn, from one of them, into star; returns how many, or -1 if star is too short."""
    at, count = corner, 0
    while True:
        if count == len(star):
            return -1
        star[count] = at
        count += 1
        at = following(opposite[following(at)])
        if at == corner:
            return count
