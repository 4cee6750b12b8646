"""Voxels of a file, packed or not, that become labels a piece at a time. What all formats of volumes share."""

from __future__ import annotations

import gzip
import math
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, LimitError
from core.label_volume import LARGEST_LABEL, Labels

GZIP = b"\x1f\x8b"
PIECE_BYTES = 4 << 20
WHOLE = 1e-3  # a scaled value is a whole number within this
MOST_LABELS = 1024  # a picture has thousands of different values
MOST_VOXELS = 1 << 27  # 512 x 512 x 512


def open_packed(path: Path) -> BinaryIO:
    """The bytes of a file, unpacked as they are read if it is gzip."""
    with path.open("rb") as file:
        packed = file.read(2) == GZIP
    return gzip.open(path, "rb") if packed else path.open("rb")  # type: ignore[return-value] # GzipFile reads like a file


def read_exactly(file: BinaryIO, count: int, what: str) -> bytes:
    """The next `count` bytes. Raises: InputError `volume.truncated`."""
    data = file.read(count)
    if len(data) < count:
        raise InputError(
            "volume.truncated", f"the file ends in {what}: {len(data)} of {count} bytes are there", missing=count - len(data)
        )
    return data


def require_size(shape: tuple[int, int, int]) -> None:
    """Before memory is asked for. Raises: LimitError `volume.too_large`."""
    voxels = math.prod(shape)
    if voxels > MOST_VOXELS:
        raise LimitError(
            "volume.too_large",
            f"{voxels} voxels are more than {MOST_VOXELS}; take a coarser volume",
            voxels=voxels,
            most=MOST_VOXELS,
        )


def read_labels(
    file: BinaryIO, shape: tuple[int, int, int], kind: np.dtype[Any], slope: float = 1.0, intercept: float = 0.0
) -> Labels:
    """All voxels (I, J, K), the first axis fastest, a piece at a time: of what is not yet a label only one is in memory.

    kind: of a value in the file; times `slope` plus `intercept` it is a label.
    Raises: InputError `volume.truncated`, `volume.not_labels`, `volume.not_integer`, `volume.label_range`, `volume.no_labels`.
    """
    count = math.prod(shape)
    labels = np.empty(count, dtype=np.uint16)
    step = PIECE_BYTES // kind.itemsize
    for first in range(0, count, step):
        wanted = min(step, count - first)
        data = read_exactly(file, wanted * kind.itemsize, f"the voxels (of {count} at {first})")
        labels[first : first + wanted] = _as_labels(np.frombuffer(data, kind), slope, intercept)
    found = int(np.count_nonzero(np.bincount(labels)[1:]))
    if found > MOST_LABELS:
        raise InputError(
            "volume.not_labels",
            f"the voxels have {found} different values, {MOST_LABELS} are the most: this is a picture rather than labels",
            values=found,
            most=MOST_LABELS,
        )
    if not found:
        raise InputError("volume.no_labels", f"all {count} voxels of the volume are 0: nothing is labelled", voxels=count)
    return labels.reshape(shape, order="F")


def _as_labels(values: NDArray[np.generic], slope: float, intercept: float) -> Labels:
    numbers: NDArray[np.generic] = values
    scaled = (slope, intercept) != (1.0, 0.0)
    if scaled:
        numbers = values.astype(np.float64) * slope + intercept
    if numbers.dtype.kind == "f":
        with np.errstate(invalid="ignore"):
            whole = np.rint(numbers)
            off = ~(np.abs(numbers - whole) <= (WHOLE if scaled else 0.0))
        if off.any():
            raise InputError(
                "volume.not_integer",
                f"{int(off.sum())} values are no whole numbers, the first is {numbers[off][0]:g}: labels are",
                count=int(off.sum()),
            )
        numbers = whole
    if numbers.size and (numbers.min() < 0 or numbers.max() > LARGEST_LABEL):
        raise InputError(
            "volume.label_range", f"values run from {numbers.min():g} to {numbers.max():g}; labels are 0 to {LARGEST_LABEL}"
        )
    return numbers.astype(np.uint16)
