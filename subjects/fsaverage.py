"""FreeSurfer's average head, inner skull and brain: from the wheels `mne` (FIF) and `nilearn` (GIFTI), read without them."""

from __future__ import annotations

import base64
import gzip
import struct
import zlib
from functools import lru_cache
from typing import Literal
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from subjects.wheel_file import wheel_file

FIF_VERTICES, FIF_TRIANGLES = 3105, 3106  # tags of a surface; numbers are 1-based, places in metres
M_TO_MM = 1000.0


@lru_cache(maxsize=2)
def fsaverage(part: Literal["head", "inner_skull-bem"]) -> Mesh:
    """The average subject's head or inner skull in mm. Raises: LookupError if the wheel is missing."""
    data = wheel_file("mne", f"mne/data/fsaverage/fsaverage-{part}.fif").read_bytes()
    blocks = _fif_blocks(data)
    vertices = np.frombuffer(blocks[FIF_VERTICES], dtype=">f4").reshape(-1, 3)
    faces = np.frombuffer(blocks[FIF_TRIANGLES], dtype=">i4").reshape(-1, 3) - 1
    return Mesh.of(vertices * M_TO_MM, faces).rounded_to_float32()


def _fif_blocks(data: bytes) -> dict[int, bytes]:
    """Tags of a FIF file: kind, type, size, next as four big-endian integers, then the values; matrices end in their shape."""
    blocks, at = {}, 0
    while at + 16 <= len(data):
        kind, type_, size, following = struct.unpack(">4i", data[at : at + 16])
        payload = data[at + 16 : at + 16 + size]
        is_matrix = type_ & 0x40000000 != 0
        blocks[kind] = payload[:-12] if is_matrix else payload
        at = following if following > 0 else at + 16 + size
        if following < 0:
            break
    return blocks


@lru_cache(maxsize=4)
def brain(surface: Literal["pial", "white"], side: Literal["left", "right"]) -> Mesh:
    """One hemisphere of fsaverage5 in mm, 20,480 faces. Raises: LookupError if the wheel is missing."""
    path = wheel_file("nilearn", f"nilearn/datasets/data/fsaverage5/{surface}_{side}.gii.gz")
    root = ElementTree.fromstring(gzip.decompress(path.read_bytes()))  # noqa: S314 - a locked wheel's own file
    arrays = {array.get("Intent"): _gifti_array(array) for array in root.iter("DataArray")}
    return Mesh.of(arrays["NIFTI_INTENT_POINTSET"], arrays["NIFTI_INTENT_TRIANGLE"]).rounded_to_float32()


def _gifti_array(array: ElementTree.Element) -> NDArray[np.generic]:
    shape = [int(array.get(f"Dim{axis}", "")) for axis in range(int(array.get("Dimensionality", "")))]
    order = "<" if array.get("Endian") == "LittleEndian" else ">"
    kind = {"NIFTI_TYPE_FLOAT32": "f4", "NIFTI_TYPE_INT32": "i4"}[array.get("DataType", "")]
    packed = base64.b64decode(array.findtext("Data", ""))
    raw = zlib.decompress(packed) if array.get("Encoding") == "GZipBase64Binary" else packed
    return np.frombuffer(raw, dtype=order + kind).reshape(shape)
