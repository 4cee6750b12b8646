"""Label volumes in NIfTI files, .nii and .nii.gz."""

from __future__ import annotations

from typing import BinaryIO

from core.errors import InputError
from core.io.nifti_header import NiftiHeader, read_header, size_of_header
from core.io.unit import MM_PER_UNIT, Unit
from core.io.voxels import read_exactly, read_labels
from core.label_volume import LabelVolume
from core.schema.finding import Finding, Severity


def begins_nifti(head: bytes) -> bool:
    """True if the first bytes, unpacked, are those of a header, or of one of a pair."""
    size = size_of_header(head)
    return size is not None and (head[4:7] in (b"n+2", b"ni2") if size == 540 else head[344:347] in (b"n+1", b"ni1"))


def read_nifti(file: BinaryIO, unit: Unit) -> tuple[LabelVolume, tuple[Finding, ...]]:
    """The labels and what was noticed. `unit` counts where the header tells none.

    Raises: InputError `nifti.*`, `volume.*`; LimitError `volume.too_large`.
    """
    start = file.read(4)
    size = size_of_header(start)
    if size is None:
        raise InputError("nifti.header", f"the file begins with {start.hex()}, which is no NIfTI header")
    head = start + read_exactly(file, size - 4, "the header")
    header = read_header(head)
    scale, findings = _scale(header, unit)
    read_exactly(file, header.offset - size, "the extensions")
    labels = read_labels(file, header.shape, header.type, header.slope, header.intercept)
    affine = header.affine.copy()
    affine[:3] *= scale
    return LabelVolume.of(labels, affine), tuple(findings)


def _scale(header: NiftiHeader, unit: Unit) -> tuple[float, list[Finding]]:
    """mm per unit of the affine, and what there is to say about it."""
    findings = []
    if not header.oriented:
        message = "the header tells the size of voxels but not where they are: the first voxel was put at the origin"
        findings.append(_noticed("volume.not_oriented", Severity.WARNING, message))
    told = header.mm_per_unit
    if told is not None and unit != "mm" and MM_PER_UNIT[unit] != told:
        raise InputError("volume.unit_differs", f"{unit} was said of the file, its header says units of {told:g} mm")
    if told is None:
        findings.append(_noticed("nifti.unit_unknown", Severity.INFO, f"the header tells no unit of length; {unit} was taken"))
    return MM_PER_UNIT[unit] if told is None else told, findings


def _noticed(code: str, severity: Severity, message: str) -> Finding:
    return Finding(code=code, severity=severity, message=message, count=1)
