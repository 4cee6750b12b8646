"""One step's output as a file: SHA-256 of the rest, size of the directory, directory (JSON), arrays in little-endian C order."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections.abc import Iterator
from pathlib import Path
from struct import Struct
from typing import Any

import numpy as np

from core.processes.checkpoints.plain import NUMBERS, Array, Plain

MAGIC = b"integument step 1\n"
HEAD = Struct("<32sQ")  # digest of all that follows it, bytes of the directory


class DamagedError(ValueError):
    """A file that is not what was written: cut off, changed, or of another kind."""


def size_of(plain: Plain) -> int:
    """Bytes the file will have, apart from its directory."""
    return sum(array.nbytes for array in plain.arrays)


def write(plain: Plain, path: Path) -> None:
    """All or nothing: written beside its place, then renamed. Raises OSError."""
    beside = path.with_name(path.name + ".part")
    directory = json.dumps(
        {"tree": plain.tree, "arrays": [[_little(array).dtype.str, list(array.shape)] for array in plain.arrays]}
    ).encode()
    try:
        with beside.open("wb") as file:
            file.write(MAGIC + HEAD.pack(bytes(32), len(directory)))
            digest = hashlib.sha256()
            for block in _blocks(directory, plain.arrays):
                digest.update(block)
                file.write(block)
            file.seek(0)
            file.write(MAGIC + HEAD.pack(digest.digest(), len(directory)))
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def read(path: Path) -> Plain:
    """Raises DamagedError, OSError."""
    data = memoryview(path.read_bytes())
    begin = len(MAGIC) + HEAD.size
    if len(data) < begin or data[: len(MAGIC)] != MAGIC:
        raise DamagedError("it does not begin with the mark of this form")
    digest, length = HEAD.unpack_from(data, len(MAGIC))
    if hashlib.sha256(data[begin:]).digest() != digest:
        raise DamagedError("its checksum does not fit")
    try:
        directory = json.loads(bytes(data[begin : begin + length]))
        return Plain(directory["tree"], tuple(_arrays(data, begin + length, directory["arrays"])))
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise DamagedError(f"its directory does not fit: {error}") from error


def _blocks(directory: bytes, arrays: tuple[Array, ...]) -> Iterator[bytes | memoryview]:
    yield directory
    for array in arrays:
        yield np.ascontiguousarray(_little(array)).data


def _little(array: Array) -> Array:
    return array.astype(array.dtype.newbyteorder("<"), copy=False)


def _arrays(data: memoryview, offset: int, entries: list[Any]) -> Iterator[Array]:
    for kind, shape in entries:
        dtype = np.dtype(str(kind))
        if dtype.kind not in NUMBERS:
            raise ValueError(f"an array of {kind} is no array of numbers")
        count = math.prod(shape)
        yield np.frombuffer(data, dtype, count, offset).reshape(shape)
        offset += count * dtype.itemsize
    if offset != len(data):
        raise ValueError(f"arrays end at byte {offset}, the file at {len(data)}")
