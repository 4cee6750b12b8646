"""Volumes of FreeSurfer made number by number, true or lying."""

from __future__ import annotations

import struct

import numpy as np
from numpy.typing import NDArray

CODES = {"u1": 0, "i4": 1, "f4": 3, "i2": 4, "u2": 10}
CORONAL = (-1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0)


def mgh(
    values: NDArray[np.generic],
    *,
    sides: tuple[float, ...] = (1.0, 1.0, 1.0),
    axes: tuple[float, ...] = CORONAL,
    middle: tuple[float, ...] = (0.0, 0.0, 0.0),
    version: int = 1,
    shape: tuple[int, ...] | None = None,
    frames: int = 1,
    code: int | None = None,
    placed: int = 1,
    tail: bytes = b"",
) -> bytes:
    """A file of `values` (I, J, K); axes: directions of i, j and k one after the other."""
    kind = CODES.get(values.dtype.str[1:], 0) if code is None else code
    head = struct.pack(">7ih15f", version, *(shape or values.shape), frames, kind, 0, placed, *sides, *axes, *middle)
    data = values.astype(values.dtype.newbyteorder(">")).tobytes(order="F")
    return head.ljust(284, b"\0") + data + tail
