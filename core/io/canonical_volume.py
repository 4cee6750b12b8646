"""The internal form of a label volume on disk: raw numbers, no code, equal volumes give equal bytes.

Layout: 8 bytes magic, uint32 CRC-32 of all that follows, 3 uint32 voxels along i, j, k, 16 float64 of the affine by rows,
then the labels, uint16 in C order, as one zlib stream. All numbers little-endian.
"""

from __future__ import annotations

import math
import struct
import zlib
from pathlib import Path

import numpy as np

from core.errors import InputError, InternalError
from core.label_volume import LabelVolume

MAGIC = b"INTVOXL1"
PREFIX = struct.Struct("<8sI")
FRAME = struct.Struct("<3I16d")
LEVEL = 1


def save_volume(volume: LabelVolume, path: Path) -> None:
    """Write the volume."""
    frame = FRAME.pack(*volume.labels.shape, *volume.affine.ravel())
    packed = zlib.compress(volume.labels.astype("<u2").tobytes(), LEVEL)
    with path.open("wb") as file:
        file.write(PREFIX.pack(MAGIC, zlib.crc32(packed, zlib.crc32(frame))))
        file.write(frame)
        file.write(packed)


def load_volume(path: Path) -> LabelVolume:
    """Read it back. Raises: InternalError `canonical.corrupt`."""
    data = path.read_bytes()
    try:
        magic, checksum = PREFIX.unpack_from(data)
        if magic != MAGIC or zlib.crc32(memoryview(data)[PREFIX.size :]) != checksum:
            raise ValueError("it has another mark or checksum")
        numbers = FRAME.unpack_from(data, PREFIX.size)
        shape = numbers[:3]
        size = 2 * math.prod(shape)
        unpacker = zlib.decompressobj()
        labels = unpacker.decompress(memoryview(data)[PREFIX.size + FRAME.size :], size + 1)
        if len(labels) != size:
            raise ValueError(f"{size} bytes of labels are wanted, {len(labels)} are there")
        return LabelVolume.of(np.frombuffer(labels, "<u2").reshape(shape), np.array(numbers[3:]).reshape(4, 4))
    except (ValueError, struct.error, zlib.error, InputError) as error:
        raise InternalError("canonical.corrupt", f"a stored volume cannot be read: {error}") from error
