"""The internal form of a mesh on disk: what the store keeps and jobs load. Raw arrays, no code, equal meshes give equal bytes.

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

from core.errors import InputError, InternalError
from core.mesh import Mesh

MAGIC = b"INTMESH1"
PREFIX = struct.Struct("<8sII")
ALIGNMENT = 64
TYPES: dict[str, np.dtype[np.generic]] = {"<f8": np.dtype("<f8"), "<i4": np.dtype("<i4")}
PER_VERTEX = "vertex:"


def save(mesh: Mesh, path: Path, arrays: Mapping[str, NDArray[np.float64] | NDArray[np.int32]] | None = None) -> None:
    """Write the mesh and, by name, arrays with one row per vertex (V, ...), float64 or int32."""
    tables: dict[str, NDArray[np.generic]] = {"vertices": mesh.vertices, "faces": mesh.faces}
    for name, values in sorted((arrays or {}).items()):
        if len(values) != len(mesh.vertices) or values.dtype not in (np.float64, np.int32):
            raise ValueError(
                f"array {name} has shape {values.shape} and type {values.dtype}; a row per vertex, float64 or int32, wanted"
            )
        tables[PER_VERTEX + name] = values
    parts = [np.ascontiguousarray(table.astype(table.dtype.newbyteorder("<"), copy=False)) for table in tables.values()]
    entries = [{"name": name, "type": part.dtype.str, "shape": part.shape} for name, part in zip(tables, parts, strict=True)]
    directory = _padded(json.dumps(entries, separators=(",", ":")).encode(), PREFIX.size)
    blocks = [directory, *(_padded(part.tobytes()) for part in parts)]
    checksum = 0
    for block in blocks:
        checksum = zlib.crc32(block, checksum)
    with path.open("wb") as file:
        file.write(PREFIX.pack(MAGIC, len(directory), checksum))
        file.writelines(blocks)


def load(path: Path) -> Mesh:
    """Read the mesh alone. Raises: InternalError `canonical.corrupt`."""
    return load_with_arrays(path)[0]


def load_with_arrays(path: Path) -> tuple[Mesh, dict[str, NDArray[np.generic]]]:
    """Read the mesh and its per-vertex arrays (read-only). Raises: InternalError `canonical.corrupt`."""
    data = path.read_bytes()
    if len(data) < PREFIX.size:
        raise _corrupt(f"{len(data)} bytes are fewer than the {PREFIX.size} of the prefix")
    magic, directory_size, checksum = PREFIX.unpack_from(data)
    if magic != MAGIC:
        raise _corrupt("it does not begin with the mark of this form")
    if zlib.crc32(memoryview(data)[PREFIX.size :]) != checksum:
        raise _corrupt(f"the checksum of its {len(data)} bytes does not fit")
    try:
        tables = _read_tables(data, PREFIX.size + directory_size)
        mesh = Mesh.of(tables.pop("vertices"), tables.pop("faces"))
    except (ValueError, TypeError, KeyError, RecursionError, InputError) as error:  # written by another version of this module
        raise _corrupt(f"its directory does not describe a mesh: {error}") from error
    return mesh, {name.removeprefix(PER_VERTEX): values for name, values in tables.items()}


def _read_tables(data: bytes, offset: int) -> dict[str, NDArray[np.generic]]:
    """All arrays as read-only views of `data`. Raises: ValueError, TypeError, KeyError where the directory is wrong."""
    tables: dict[str, NDArray[np.generic]] = {}
    for entry in json.loads(data[PREFIX.size : offset].rstrip(b"\0")):
        kind, shape = TYPES[entry["type"]], tuple(entry["shape"])
        count = math.prod(shape)
        tables[entry["name"]] = np.frombuffer(data, kind, count, offset).reshape(shape)
        size = count * kind.itemsize
        offset += size + -size % ALIGNMENT
    if offset != len(data):
        raise ValueError(f"arrays end at byte {offset}, the file at {len(data)}")
    return tables


def _padded(block: bytes, already: int = 0) -> bytes:
    return block + bytes(-(len(block) + already) % ALIGNMENT)


def _corrupt(reason: str) -> InternalError:
    return InternalError("canonical.corrupt", f"a stored mesh cannot be read: {reason}")
