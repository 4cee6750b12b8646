"""NIfTI files made number by number, true or lying."""

from __future__ import annotations

import gzip
import struct

import numpy as np
from numpy.typing import ArrayLike, NDArray

CODES = {"u1": 2, "i2": 4, "i4": 8, "f4": 16, "f8": 64, "i1": 256, "u2": 512, "u4": 768, "i8": 1024, "u8": 1280}

MOST_PADDING = 4096


def nifti(
    values: NDArray[np.generic],
    affine: ArrayLike | None = None,
    *,
    version: int = 1,
    order: str = "<",
    dim: tuple[int, ...] | None = None,
    datatype: int | None = None,
    bitpix: int | None = None,
    slope: float = 0.0,
    intercept: float = 0.0,
    units: int = 2,
    quaternion: tuple[float, ...] | None = None,
    pixdim: tuple[float, ...] = (1.0, 1.0, 1.0, 1.0),
    magic: bytes | None = None,
    offset: int | None = None,
    tail: bytes = b"",
) -> bytes:
    """A file of `values` in the place the affine says (sform), or quaternion (b, c, d, x, y, z), or neither."""
    kind = values.dtype.str[1:]
    shape = dim or (values.ndim, *values.shape)
    dims = (*shape, *[1] * (8 - len(shape)))
    code = CODES.get(kind, 0) if datatype is None else datatype
    bits = 8 * values.dtype.itemsize if bitpix is None else bitpix
    sides = (*pixdim, *[0.0] * (8 - len(pixdim)))
    rows = np.zeros((3, 4)) if affine is None else np.asarray(affine, dtype=float)[:3]
    forms = (int(quaternion is not None), int(affine is not None))
    places = quaternion or (0.0,) * 6
    size = 348 if version == 1 else 540
    start = size + 4 if offset is None else offset
    head = bytearray(size)
    if version == 1:
        struct.pack_into(order + "i", head, 0, size)
        struct.pack_into(order + "8h", head, 40, *dims)
        struct.pack_into(order + "hh", head, 70, code, bits)
        struct.pack_into(order + "8f", head, 76, *sides)
        struct.pack_into(order + "3f", head, 108, start, slope, intercept)
        head[123] = units
        struct.pack_into(order + "hh", head, 252, *forms)
        struct.pack_into(order + "6f", head, 256, *places)
        struct.pack_into(order + "12f", head, 280, *rows.ravel())
        head[344:348] = magic or b"n+1\0"
    else:
        struct.pack_into(order + "i", head, 0, size)
        head[4:12] = (magic or b"n+2\0\r\n\x1a\n").ljust(8, b"\0")
        struct.pack_into(order + "hh", head, 12, code, bits)
        struct.pack_into(order + "8q", head, 16, *dims)
        struct.pack_into(order + "8d", head, 104, *sides)
        struct.pack_into(order + "q", head, 168, start)
        struct.pack_into(order + "2d", head, 176, slope, intercept)
        struct.pack_into(order + "ii", head, 344, *forms)
        struct.pack_into(order + "6d", head, 352, *places)
        struct.pack_into(order + "12d", head, 400, *rows.ravel())
        struct.pack_into(order + "i", head, 500, units)
    data = values.astype(values.dtype.newbyteorder(order)).tobytes(order="F")
    padding = bytes(min(max(0, start - size), MOST_PADDING))  # a header may promise more than there is
    return bytes(head) + padding + data + tail


def packed(data: bytes) -> bytes:
    """As .nii.gz."""
    return gzip.compress(data, 1, mtime=0)


def two_boxes() -> NDArray[np.uint8]:
    """5 x 6 x 7 voxels: label 1 in 2 x 2 x 2 of them, label 7 in 1 x 2 x 3."""
    labels = np.zeros((5, 6, 7), dtype=np.uint8)
    labels[1:3, 1:3, 1:3] = 1
    labels[3, 3:5, 2:5] = 7
    return labels
