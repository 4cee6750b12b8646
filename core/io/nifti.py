"""Label volumes in NIfTI files, .nii and .nii.gz. Written here: a few numbers of a header, and nothing is unpacked unasked."""

from __future__ import annotations

import gzip
import math
import zlib
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.io.nifti_header import NiftiHeader, read_header, size_of_header
from core.io.unit import MM_PER_UNIT, Unit
from core.label_volume import LARGEST_LABEL, Labels, LabelVolume
from core.schema.finding import Finding, Severity

EXTENSIONS = (".nii", ".nii.gz")
GZIP = b"\x1f\x8b"
PIECE_BYTES = 4 << 20
WHOLE = 1e-3  # a scaled value is a whole number within this
MOST_LABELS = 1024  # a picture has thousands of different values


def is_nifti(path: Path, file_name: str = "") -> bool:
    """True if a NIfTI header begins in the first bytes, packed or not, or the user calls it so; the rest is `read_volume`'s."""
    if file_name.lower().endswith(EXTENSIONS):
        return path.stat().st_size > 0
    try:
        with _opened(path) as file:
            head = file.read(348)
    except (OSError, EOFError, zlib.error):
        return False
    size = size_of_header(head)
    return size is not None and (head[4:7] in (b"n+2", b"ni2") if size == 540 else head[344:347] in (b"n+1", b"ni1"))


def read_volume(path: Path, unit: Unit) -> tuple[LabelVolume, tuple[Finding, ...]]:
    """The labels and what was noticed. `unit` counts where the header tells none.

    Raises: InputError `nifti.*`, `volume.*`; LimitError `nifti.too_large`; MemoryError if the process may not have what it needs.
    """
    try:
        with _opened(path) as file:
            start = file.read(4)
            size = size_of_header(start)
            if size is None:
                raise InputError("nifti.header", f"the file begins with {start.hex()}, which is no NIfTI header")
            head = start + _exactly(file, size - 4, "the header")
            header = read_header(head)
            scale, findings = _scale(header, unit)
            _exactly(file, header.offset - size, "the extensions")
            labels = _read_labels(file, header)
            rest = len(file.read(1))  # to the end of what is packed, where its checksum is
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputError("nifti.truncated", f"the packed file is cut off or damaged: {error}") from error
    if rest:
        findings.append(_noticed("nifti.bytes_after", Severity.INFO, "there are bytes after the last voxel; they were not read"))
    affine = header.affine.copy()
    affine[:3] *= scale
    return LabelVolume.of(labels, affine), tuple(findings)


def _opened(path: Path) -> BinaryIO:
    with path.open("rb") as file:
        packed = file.read(2) == GZIP
    return gzip.open(path, "rb") if packed else path.open("rb")  # type: ignore[return-value] # GzipFile reads like a file


def _exactly(file: BinaryIO, count: int, what: str) -> bytes:
    data = file.read(count)
    if len(data) < count:
        raise InputError(
            "nifti.truncated", f"the file ends in {what}: {len(data)} of {count} bytes are there", missing=count - len(data)
        )
    return data


def _scale(header: NiftiHeader, unit: Unit) -> tuple[float, list[Finding]]:
    """mm per unit of the affine, and what there is to say about it."""
    findings = []
    if not header.oriented:
        message = "the header tells the size of voxels but not where they are: the first voxel was put at the origin"
        findings.append(_noticed("nifti.not_oriented", Severity.WARNING, message))
    told = header.mm_per_unit
    if told is not None and unit != "mm" and MM_PER_UNIT[unit] != told:
        raise InputError("nifti.unit_differs", f"{unit} was said of the file, its header says units of {told:g} mm")
    if told is None:
        findings.append(_noticed("nifti.unit_unknown", Severity.INFO, f"the header tells no unit of length; {unit} was taken"))
    return MM_PER_UNIT[unit] if told is None else told, findings


def _noticed(code: str, severity: Severity, message: str) -> Finding:
    return Finding(code=code, severity=severity, message=message, count=1)


def _read_labels(file: BinaryIO, header: NiftiHeader) -> Labels:
    """All voxels (I, J, K), a piece at a time: of what is not yet a label only one is in memory."""
    count = math.prod(header.shape)
    labels = np.empty(count, dtype=np.uint16)
    step = PIECE_BYTES // header.type.itemsize
    for first in range(0, count, step):
        wanted = min(step, count - first)
        data = _exactly(file, wanted * header.type.itemsize, f"the voxels (of {count} at {first})")
        labels[first : first + wanted] = _as_labels(np.frombuffer(data, header.type), header)
    found = int(np.count_nonzero(np.bincount(labels)[1:]))
    if found > MOST_LABELS:
        raise InputError(
            "nifti.not_labels",
            f"the voxels have {found} different values, {MOST_LABELS} are the most: this is a picture rather than labels",
            values=found,
            most=MOST_LABELS,
        )
    if not found:
        raise InputError("volume.no_labels", f"all {count} voxels of the volume are 0: nothing is labelled", voxels=count)
    return labels.reshape(header.shape, order="F")


def _as_labels(values: NDArray[np.generic], header: NiftiHeader) -> Labels:
    numbers: NDArray[np.generic] = values
    scaled = (header.slope, header.intercept) != (1.0, 0.0)
    if scaled:
        numbers = values.astype(np.float64) * header.slope + header.intercept
    if numbers.dtype.kind == "f":
        with np.errstate(invalid="ignore"):
            whole = np.rint(numbers)
            off = ~(np.abs(numbers - whole) <= (WHOLE if scaled else 0.0))
        if off.any():
            raise InputError(
                "nifti.not_integer",
                f"{int(off.sum())} values are no whole numbers, the first is {numbers[off][0]:g}: labels are",
                count=int(off.sum()),
            )
        numbers = whole
    if numbers.size and (numbers.min() < 0 or numbers.max() > LARGEST_LABEL):
        raise InputError(
            "nifti.label_range", f"values run from {numbers.min():g} to {numbers.max():g}; labels are 0 to {LARGEST_LABEL}"
        )
    return numbers.astype(np.uint16)
