"""The header of a NIfTI file, version 1 or 2: every number checked before anything is done with it."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.io.voxels import require_size

SIZES = {348: 1, 540: 2}
MAGIC_1 = b"n+1\0"
MAGIC_2 = b"n+2\0\r\n\x1a\n"
PAIRS = (b"ni1\0", b"ni2\0")
TYPES: dict[int, str] = {
    2: "u1",
    4: "i2",
    8: "i4",
    16: "f4",
    64: "f8",
    256: "i1",
    512: "u2",
    768: "u4",
    1024: "i8",
    1280: "u8",
}
MM_PER_CODE = {1: 1000.0, 2: 1.0, 3: 0.001}
LARGEST_OFFSET = 16 << 20  # bytes of extensions between header and voxels


@dataclass(frozen=True, eq=False, slots=True)
class NiftiHeader:
    """What is needed to read the voxels.

    shape: voxels along i, j, k. type: of a value in the file. offset: of the first value in bytes. slope, intercept: value in the
    file -> label. mm_per_unit: None if the header does not say. affine: (4, 4) in the header's unit. oriented: False if it says
    nothing but the size of a voxel.
    """

    shape: tuple[int, int, int]
    type: np.dtype[Any]
    offset: int
    slope: float
    intercept: float
    mm_per_unit: float | None
    affine: NDArray[np.float64]
    oriented: bool


def size_of_header(start: bytes) -> int | None:
    """Its size in bytes, from the first four of the file; None if no NIfTI header begins so."""
    sizes = [int.from_bytes(start[:4], order) for order in ("little", "big")] if len(start) >= 4 else []
    return next((size for size in sizes if size in SIZES), None)


def read_header(head: bytes) -> NiftiHeader:
    """`head` has the size that `size_of_header` told.

    Raises: InputError `nifti.header`, `nifti.pair`, `nifti.dimensions`, `nifti.datatype`, `nifti.unit`; LimitError
    `volume.too_large`.
    """
    order = "<" if int.from_bytes(head[:4], "little") in SIZES else ">"
    first = int.from_bytes(head[:4], "little" if order == "<" else "big") == 348
    magic = head[344:348] if first else head[4:12]
    if magic[:4] in PAIRS:
        raise InputError("nifti.pair", "the header is of a pair .hdr and .img; save it as one file .nii")
    if magic != (MAGIC_1 if first else MAGIC_2):
        raise InputError("nifti.header", f"the header has no mark of NIfTI-{1 if first else 2}: {magic.hex()}")

    def numbers(form: str, at_1: int, at_2: int) -> tuple[Any, ...]:
        """`form` as of version 1; the second version has wider numbers."""
        wide = form.replace("i", "q").replace("h", "q").replace("f", "d")
        return struct.unpack_from(order + (form if first else wide), head, at_1 if first else at_2)

    shape = _shape(numbers("8h", 40, 16))
    code, bits = struct.unpack_from(order + "hh", head, 70 if first else 12)
    if code not in TYPES:
        known = ", ".join(np.dtype(name).name for name in TYPES.values())
        raise InputError("nifti.datatype", f"values of the type {code} are no labels; known are {known}", datatype=code)
    kind = np.dtype(order + TYPES[code])
    if bits != 8 * kind.itemsize:
        raise InputError("nifti.datatype", f"the header says {bits} bits for values of {8 * kind.itemsize}", bits=bits)
    (start,) = numbers("f", 108, 168) if first else struct.unpack_from(order + "q", head, 168)
    offset = _offset(float(start), len(head))
    slope, intercept = (float(number) for number in numbers("2f", 112, 176))
    if slope == 0.0 or not math.isfinite(slope) or not math.isfinite(intercept):
        slope, intercept = 1.0, 0.0  # as the standard has it: not scaled
    pixdim = np.array(numbers("8f", 76, 104))
    forms = struct.unpack_from(order + "hh", head, 252) if first else struct.unpack_from(order + "ii", head, 344)
    quaternion = np.array(numbers("6f", 256, 352))
    rows = np.array(numbers("12f", 280, 400)).reshape(3, 4)
    affine = np.eye(4)
    if forms[1] > 0:
        affine[:3] = rows
    elif forms[0] > 0:
        affine[:3] = _placed(pixdim, quaternion)
    else:
        affine[:3, :3] = np.diag(np.abs(pixdim[1:4]))
    units = head[123] if first else int(struct.unpack_from(order + "i", head, 500)[0])
    return NiftiHeader(shape, kind, offset, slope, intercept, _mm_per_unit(units & 7), affine, max(forms) > 0)


def _shape(dim: tuple[int, ...]) -> tuple[int, int, int]:
    count = dim[0]
    if not 1 <= count <= 7 or any(side < 1 for side in dim[1 : count + 1]):
        raise InputError("nifti.dimensions", f"the header tells the dimensions {list(dim)}")
    sides = [*dim[1 : count + 1], 1, 1]
    if count > 3 and any(side != 1 for side in sides[3:]):
        raise InputError(
            "nifti.dimensions",
            f"the volume has {' x '.join(str(side) for side in dim[1 : count + 1])} values; a label volume has three dimensions",
            dimensions=count,
        )
    shape = (sides[0], sides[1], sides[2])
    require_size(shape)
    return shape


def _offset(start: float, least: int) -> int:
    if not least <= start <= LARGEST_OFFSET or start != int(start):
        raise InputError("nifti.header", f"the voxels are to begin at byte {start:g}; {least} to {LARGEST_OFFSET} make sense")
    return int(start)


def _mm_per_unit(code: int) -> float | None:
    if code == 0:
        return None
    if code not in MM_PER_CODE:
        raise InputError("nifti.unit", f"the unit of length has the code {code}; known are 1 (m), 2 (mm) and 3 (µm)", unit=code)
    return MM_PER_CODE[code]


def _placed(pixdim: NDArray[np.float64], form: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation by a quaternion, size of voxels and offset: (3, 4). Source: the standard's method 2 (nifti1.h)."""
    b, c, d = form[:3]
    left = 1.0 - (b * b + c * c + d * d)
    if left < 1e-7:
        b, c, d = form[:3] / max(float(np.linalg.norm(form[:3])), 1e-300)
    a = math.sqrt(left) if left >= 1e-7 else 0.0
    rotation = np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c],
        ]
    )
    sides = np.abs(pixdim[1:4]) * np.array([1.0, 1.0, -1.0 if pixdim[0] < 0 else 1.0])
    return np.column_stack((rotation * sides, form[3:]))
