"""Label volumes in files of FreeSurfer, .mgh and .mgz: a header of fixed size, then the voxels, always in mm.

Source: FreeSurfer's description of its MGH format (surfer.nmr.mgh.harvard.edu/fswiki/FsTutorial/MghFormat).
"""

from __future__ import annotations

import math
import struct
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.io.unit import Unit
from core.io.voxels import read_exactly, read_labels, require_size
from core.label_volume import LabelVolume
from core.schema.finding import Finding, Severity

HEADER_BYTES = 284
VERSION = 1
MOST_PER_SIDE = 32_767
TYPES = {0: "u1", 1: ">i4", 3: ">f4", 4: ">i2", 10: ">u2"}
LARGEST_SIDE_MM = 1e4
CORONAL = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""How voxels lie where the header does not say: its axes are the columns."""


def begins_mgh(head: bytes) -> bool:
    """True if the first bytes make sense as a header. There is no mark, so all numbers have a say."""
    if len(head) < HEADER_BYTES:
        return False
    version, *sides, frames, kind = struct.unpack_from(">6i", head)
    (placed,) = struct.unpack_from(">h", head, 28)
    right = all(1 <= side <= MOST_PER_SIDE for side in (*sides, frames))
    return version == VERSION and right and 0 <= kind <= max(TYPES) and placed in (0, 1)


def read_mgh(file: BinaryIO, unit: Unit) -> tuple[LabelVolume, tuple[Finding, ...]]:
    """The labels and what was noticed. `unit` must be mm: the format has no other.

    Raises: InputError `mgh.*`, `volume.*`; LimitError `volume.too_large`.
    """
    head = read_exactly(file, HEADER_BYTES, "the header")
    version, *sides, frames, code = struct.unpack_from(">6i", head)
    # the higher bytes of the first number tell what newer files are meant for
    if version & 0xFF != VERSION or min(*sides, frames) < 1 or max(*sides, frames) > MOST_PER_SIDE:
        raise InputError(
            "mgh.header", f"the header tells version {version}, {' x '.join(map(str, sides))} voxels, and {frames} frames"
        )
    if frames != 1:
        raise InputError("mgh.frames", f"the volume has {frames} frames; a label volume has one", frames=frames)
    if code not in TYPES:
        known = ", ".join(np.dtype(name).name for name in TYPES.values())
        raise InputError("mgh.datatype", f"values of the type {code} are no labels; known are {known}", datatype=code)
    shape = (int(sides[0]), int(sides[1]), int(sides[2]))
    require_size(shape)
    if unit != "mm":
        raise InputError("volume.unit_differs", f"{unit} was said of the file; files of FreeSurfer are in mm")
    affine, findings = _affine(head, shape)
    return LabelVolume.of(read_labels(file, shape, np.dtype(TYPES[code])), affine), findings


def _affine(head: bytes, shape: tuple[int, int, int]) -> tuple[NDArray[np.float64], tuple[Finding, ...]]:
    """(4, 4) in mm, from size and directions of the voxels and the place of their middle."""
    (placed,) = struct.unpack_from(">h", head, 28)
    numbers = np.array(struct.unpack_from(">15f", head, 30), dtype=np.float64)
    affine = np.eye(4)
    if placed == 1:
        sides, axes, middle = numbers[:3], numbers[3:12].reshape(3, 3).T, numbers[12:]
        findings: tuple[Finding, ...] = ()
    else:
        sides, axes, middle = np.ones(3), CORONAL, np.zeros(3)
        message = "the header does not tell where voxels are: sides of 1 mm and the coronal order of FreeSurfer were taken"
        findings = (Finding(code="volume.not_oriented", severity=Severity.WARNING, message=message, count=1),)
    largest = float(np.abs(sides).max())
    if not math.isfinite(largest) or largest > LARGEST_SIDE_MM:
        raise InputError("mgh.header", f"the header tells voxels of {' x '.join(f'{side:g}' for side in sides)} mm")
    affine[:3, :3] = axes * sides
    with np.errstate(invalid="ignore", over="ignore"):  # judged by `LabelVolume.of`
        affine[:3, 3] = middle - affine[:3, :3] @ (np.array(shape) / 2)
    return affine, findings
