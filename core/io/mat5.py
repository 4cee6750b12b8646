"""MAT files of version 5, 6 and 7: a strict reader of top-level numeric matrices.

SciPy's loader warns that it is not for untrusted files: it unpacks without bound and crashes on crafted type numbers. This one
checks every size before using it, unpacks no more than the header of variables nobody asked for, and builds nothing but numbers.
Source: MathWorks, MAT-File Format, "Level 5 MAT-File Format".
"""

from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import LimitError
from core.io.mat5_matrix import corrupt, parse_head, read_tag
from core.io.mat_variable import LARGEST_ARRAY_BYTES, MatVariable

HEADER_BYTES = 128
HEAD_OF_MATRIX = 4096  # flags, sizes and name lie within
MATRIX, COMPRESSED = 14, 15
NUMBER_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
MOST_VARIABLES = 1000


@dataclass(frozen=True, slots=True)
class Extent:
    """Where one top-level element lies in the file."""

    start: int
    size: int
    compressed: bool


class Mat5File:
    """The bytes of a version 5 file and what they hold."""

    def __init__(self, data: bytes) -> None:
        """Find all variables. Raises: InputError `mat.corrupt`."""
        if len(data) < HEADER_BYTES:
            raise corrupt(f"the file has {len(data)} bytes, a MAT file needs at least {HEADER_BYTES}", bytes=len(data))
        mark = data[126:128]
        if mark not in (b"IM", b"MI"):
            raise corrupt("this is no MAT file of version 5 to 7.3; save it in MATLAB with save(name, 'P', 't', '-v7')")
        self._data = data
        self._order = "<" if mark == b"IM" else ">"
        self._extents: list[Extent] = []
        self._variables: list[MatVariable] = []
        offset = HEADER_BYTES
        while offset < len(data):
            offset = self._scan_element(offset)
            if len(self._extents) > MOST_VARIABLES:
                raise corrupt(f"more than {MOST_VARIABLES} variables")

    @property
    def variables(self) -> tuple[MatVariable, ...]:
        """All variables in file order."""
        return tuple(self._variables)

    def load(self, variable: MatVariable) -> NDArray[np.float64]:
        """The real numbers of a matrix as doubles. Raises: InputError `mat.corrupt`, LimitError `mat.too_large`."""
        if variable.bytes_unpacked > LARGEST_ARRAY_BYTES:
            raise LimitError(
                "mat.too_large",
                f"variable {variable.name} of shape {variable.shape} takes {variable.bytes_unpacked} bytes, "
                f"{LARGEST_ARRAY_BYTES} are allowed",
                bytes=variable.bytes_unpacked,
                limit=LARGEST_ARRAY_BYTES,
            )
        body = self._unpack(self._extents[variable.place], variable.bytes_unpacked + HEAD_OF_MATRIX, whole=True)
        offset = parse_head(body, self._order).numbers_at
        kind, start, size = read_tag(body, offset, self._order)
        if kind not in NUMBER_TYPES:
            raise corrupt(f"variable {variable.name} stores its numbers as type {kind}", type=kind)
        stored = np.dtype(self._order + NUMBER_TYPES[kind])
        count = math.prod(variable.shape)
        if size != count * stored.itemsize or start + size > len(body):
            raise corrupt(f"variable {variable.name} of shape {variable.shape} has {size} bytes of numbers", bytes=size)
        return np.frombuffer(body, stored, count, start).reshape(variable.shape, order="F").astype(np.float64)

    def _scan_element(self, offset: int) -> int:
        """Note the variable at `offset`; return where the next element begins."""
        if offset + 8 > len(self._data):
            raise corrupt(f"{len(self._data) - offset} bytes are left at byte {offset}, an element needs 8", offset=offset)
        kind, size = struct.unpack_from(self._order + "II", self._data, offset)
        end: int = offset + 8 + size
        if kind not in (MATRIX, COMPRESSED):
            raise corrupt(f"the element at byte {offset} has type {kind}, neither a matrix nor a compressed one", offset=offset)
        if end > len(self._data):
            raise corrupt(
                f"the element at byte {offset} ends at byte {end}, the file at {len(self._data)}", offset=offset, end=end
            )
        extent = Extent(offset + 8, size, compressed=kind == COMPRESSED)
        head = parse_head(self._unpack(extent, HEAD_OF_MATRIX), self._order)
        self._variables.append(MatVariable(head.name, head.matlab_class, head.shape, len(self._extents)))
        self._extents.append(extent)
        return end

    def _unpack(self, extent: Extent, most: int, *, whole: bool = False) -> memoryview:
        """The inside of a matrix element, never more than `most` bytes: its beginning, or with `whole` all of it or an error."""
        packed = memoryview(self._data)[extent.start : extent.start + extent.size]
        if not extent.compressed:
            return packed[:most]
        stream = zlib.decompressobj()
        try:
            tag = stream.decompress(packed, 8)
            kind, size = struct.unpack(self._order + "II", tag.ljust(8, b"\0"))
            if kind != MATRIX:
                raise corrupt(f"the compressed element at byte {extent.start} holds type {kind}, not a matrix", type=kind)
            if whole and size > most:
                raise corrupt(
                    f"the compressed element at byte {extent.start} declares {size} bytes, {most} at most fit", size=size
                )
            wanted = min(most, size)
            body = stream.decompress(stream.unconsumed_tail, wanted) if wanted else b""
            surplus = stream.decompress(stream.unconsumed_tail, 1) if whole else b""
        except zlib.error as error:
            raise corrupt(
                f"the compressed element at byte {extent.start} cannot be unpacked: {error}", offset=extent.start
            ) from None
        if len(body) < wanted or surplus or (whole and not stream.eof):
            raise corrupt(f"the compressed element at byte {extent.start} does not unpack to {size} bytes", offset=extent.start)
        return memoryview(body)
