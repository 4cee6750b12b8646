"""Label volumes of all formats: how they are told from other files, and the one way in.

Read by our own: a few numbers of a header, and nothing is unpacked unasked (ADR-0018).
"""

from __future__ import annotations

import gzip
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from core.errors import InputError
from core.io import mgh, nifti
from core.io.unit import Unit
from core.io.voxels import open_packed
from core.label_volume import LabelVolume
from core.schema.finding import Finding, Severity

HEAD_BYTES = 348  # what tells all formats apart
LONGEST_TAIL = 16 << 20  # bytes behind the voxels that are unpacked to reach the checksum of what is packed
PIECE_BYTES = 1 << 20


@dataclass(frozen=True, slots=True)
class VolumeFormat:
    """extensions: of the user's file names, packed and not. begins: True if the first bytes, unpacked, are of this format.

    read: from the first byte to the last voxel, with the unit said of the upload. is_followed: bytes behind the voxels belong to
    the format.
    """

    extensions: tuple[str, ...]
    begins: Callable[[bytes], bool]
    read: Callable[[BinaryIO, Unit], tuple[LabelVolume, tuple[Finding, ...]]]
    is_followed: bool


FORMATS = {
    "nifti": VolumeFormat((".nii", ".nii.gz"), nifti.begins_nifti, nifti.read_nifti, is_followed=False),
    "mgh": VolumeFormat((".mgh", ".mgz", ".mgh.gz"), mgh.begins_mgh, mgh.read_mgh, is_followed=True),
}
EXTENSIONS = tuple(ending for each in FORMATS.values() for ending in each.extensions)


def find_volume_format(path: Path, file_name: str = "") -> str | None:
    """The format whose header begins the file, packed or not, or that the user's name says; the rest is `read_volume`'s."""
    if not path.stat().st_size:
        return None
    try:
        with open_packed(path) as file:
            head = file.read(HEAD_BYTES)
    except (OSError, EOFError, zlib.error):
        head = b""
    begun = (name for name, each in FORMATS.items() if each.begins(head))
    named = (name for name, each in FORMATS.items() if file_name.lower().endswith(each.extensions))
    return next(begun, None) or next(named, None)


def read_volume(path: Path, unit: Unit, file_name: str = "") -> tuple[LabelVolume, tuple[Finding, ...], str]:
    """The labels, what was noticed, and the format; a file of none is read as NIfTI. `unit` counts where the header tells none.

    Raises: InputError `nifti.*`, `mgh.*`, `volume.*`; LimitError `volume.too_large`; MemoryError if the process may not have what
    it needs.
    """
    name = find_volume_format(path, file_name) or "nifti"
    try:
        with open_packed(path) as file:
            volume, findings = FORMATS[name].read(file, unit)
            rest = _read_to_end(file)
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise InputError("volume.truncated", f"the packed file is cut off or damaged: {error}") from error
    if rest and not FORMATS[name].is_followed:
        message = "there are bytes after the last voxel; they were not read"
        after = Finding(code="volume.bytes_after", severity=Severity.INFO, message=message, count=1)
        findings = (*findings, after)
    return volume, findings, name


def _read_to_end(file: BinaryIO) -> int:
    """Bytes that are left, as far as `LONGEST_TAIL`: behind the last is the checksum of what is packed."""
    count = 0
    while count < LONGEST_TAIL and (piece := file.read(PIECE_BYTES)):
        count += len(piece)
    return count
