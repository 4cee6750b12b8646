"""Arrays by name in one file: raw numbers, no code, equal arrays give equal bytes. The frame of every canonical form.

Layout: 8 bytes magic, uint32 length of the JSON directory, uint32 CRC-32 of all that follows, directory, arrays;
the directory and every array are padded with zeros to multiples of 64 bytes. All numbers little-endian.
"""

from __future__ import annotations

import json
import math
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InternalError

PREFIX = struct.Struct("<8sII")
ALIGNMENT = 64
TYPES: dict[str, np.dtype[np.generic]] = {code: np.dtype(code) for code in ("<f8", "<i4", "|u1")}

Table = NDArray[np.generic]


def write_arrays(path: Path, magic: bytes, tables: Mapping[str, Table]) -> None:
    """Write arrays of the types above, in the order given; `magic` is 8 bytes that tell the form."""
    parts = [np.ascontiguousarray(table.astype(table.dtype.newbyteorder("<"), copy=False)) for table in tables.values()]
    entries = [{"name": name, "type": part.dtype.str, "shape": part.shape} for name, part in zip(tables, parts, strict=True)]
    directory = _padded(json.dumps(entries, separators=(",", ":")).encode(), PREFIX.size)
    checksum = zlib.crc32(directory)
    for part in parts:
        checksum = _checksum_of(part, checksum)
    with path.open("wb") as file:
        file.write(PREFIX.pack(magic, len(directory), checksum))
        file.write(directory)
        for part in parts:
            file.write(part.data)
            file.write(bytes(-part.nbytes % ALIGNMENT))


def read_arrays(path: Path, magic: bytes) -> dict[str, Table]:
    """All arrays by name, read-only. Raises: InternalError `canonical.corrupt`."""
    data = path.read_bytes()
    if len(data) < PREFIX.size:
        raise corrupt(f"{len(data)} bytes are fewer than the {PREFIX.size} of the prefix")
    found, directory_size, checksum = PREFIX.unpack_from(data)
    if found != magic:
        raise corrupt("it does not begin with the mark of this form")
    if zlib.crc32(memoryview(data)[PREFIX.size :]) != checksum:
        raise corrupt(f"the checksum of its {len(data)} bytes does not fit")
    try:
        return _read_tables(data, PREFIX.size + directory_size)
    except (ValueError, TypeError, KeyError, RecursionError) as error:  # written by another version of this module
        raise corrupt(f"its directory does not describe arrays: {error}") from error


def corrupt(reason: str) -> InternalError:
    """What is raised for bytes that this software did not write."""
    return InternalError("canonical.corrupt", f"a stored upload cannot be read: {reason}")


def _read_tables(data: bytes, offset: int) -> dict[str, Table]:
    """All arrays as views of `data`. Raises: ValueError, TypeError, KeyError where the directory is wrong."""
    tables: dict[str, Table] = {}
    for entry in json.loads(data[PREFIX.size : offset].rstrip(b"\0")):
        kind, shape = TYPES[entry["type"]], tuple(entry["shape"])
        count = math.prod(shape)
        tables[entry["name"]] = np.frombuffer(data, kind, count, offset).reshape(shape)
        size = count * kind.itemsize
        offset += size + -size % ALIGNMENT
    if offset != len(data):
        raise ValueError(f"arrays end at byte {offset}, the file at {len(data)}")
    return tables


def _checksum_of(part: Table, before: int) -> int:
    return zlib.crc32(bytes(-part.nbytes % ALIGNMENT), zlib.crc32(part.data, before))


def _padded(block: bytes, already: int = 0) -> bytes:
    return block + bytes(-(len(block) + already) % ALIGNMENT)
