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

from core.errors import InputError, LimitError
from core.io.mat_variable import LARGEST_ARRAY_BYTES, NUMBER_CLASSES, MatVariable
from core.io.naming import clean_name

HEADER_BYTES = 128
HEAD_OF_MATRIX = 4096  # flags, sizes and name lie within
MATRIX, COMPRESSED = 14, 15
NUMBER_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
NUMBER_CLASS_CODES = {6: "double", 7: "single", 8: "int8", 9: "uint8", 10: "int16", 11: "uint16", 12: "int32", 13: "uint32"}
LONG_CLASS_CODES = {14: "int64", 15: "uint64"}
OTHER_CLASS_CODES = {1: "cell", 2: "struct", 3: "object", 4: "char", 5: "sparse", 16: "function_handle", 17: "opaque"}
CLASSES = NUMBER_CLASS_CODES | LONG_CLASS_CODES | OTHER_CLASS_CODES
COMPLEX, LOGICAL = 0x08, 0x02
MOST_VARIABLES = 1000


def corrupt(message: str, **facts: int) -> InputError:
    """The error for a MAT file that breaks its own rules."""
    error = InputError("mat.corrupt", message)
    error.facts.update(facts)
    return error


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
        self._extents: dict[MatVariable, Extent] = {}
        offset = HEADER_BYTES
        while offset < len(data):
            offset = self._scan_element(offset)
            if len(self._extents) > MOST_VARIABLES:
                raise corrupt(f"more than {MOST_VARIABLES} variables")

    @property
    def variables(self) -> tuple[MatVariable, ...]:
        """All variables in file order."""
        return tuple(self._extents)

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
        body = self._unpack(self._extents[variable], variable.bytes_unpacked + HEAD_OF_MATRIX, whole=True)
        offset = _Matrix(body, self._order).numbers_at
        kind, start, size = _read_tag(body, offset, self._order)
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
        matrix = _Matrix(self._unpack(extent, HEAD_OF_MATRIX), self._order)
        self._extents[matrix.variable] = extent
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


class _Matrix:
    """The head of one matrix element: what it is, and where its numbers begin."""

    def __init__(self, body: memoryview, order: str) -> None:
        kind, start, size = _read_tag(body, 0, order)
        if kind != 6 or size != 8:
            raise corrupt(f"a matrix begins with type {kind} of {size} bytes, array flags expected")
        flags = struct.unpack_from(order + "I", body, start)[0]
        number, bits = flags & 0xFF, flags >> 8
        self.numbers_at = 0
        if number not in CLASSES:
            raise corrupt(f"a matrix has class {number}", matlab_class=number)
        if CLASSES[number] == "opaque":  # has no size; the name follows at once
            name, _ = _read_text(body, start + 8, order)
            self.variable = MatVariable(name, "opaque", (), 0)
            return
        kind, shape_start, shape_size = _read_tag(body, start + 8, order)
        if kind != 5 or shape_size % 4 or shape_size < 8 or shape_start + shape_size > len(body):
            raise corrupt(f"a matrix has its dimensions as type {kind} of {shape_size} bytes")
        shape = struct.unpack_from(f"{order}{shape_size // 4}i", body, shape_start)
        if min(shape) < 0:
            raise corrupt(f"a matrix has the dimensions {shape[:8]}")
        name, self.numbers_at = _read_text(body, _padded(shape_start + shape_size), order)
        matlab_class = CLASSES[number]
        if bits & LOGICAL:
            matlab_class = "logical"
        elif bits & COMPLEX and matlab_class in NUMBER_CLASSES:
            matlab_class = f"complex {matlab_class}"
        self.variable = MatVariable(name, matlab_class, shape, 8 * math.prod(shape))


def _padded(offset: int) -> int:
    """Elements inside a matrix begin at multiples of 8 bytes."""
    return -(-offset // 8) * 8


def _read_tag(body: memoryview, offset: int, order: str) -> tuple[int, int, int]:
    """Type, first byte and size of the element at `offset`; up to four bytes may share the tag."""
    if offset + 8 > len(body):
        raise corrupt(f"a matrix of {len(body)} bytes ends before its parts do", bytes=len(body))
    first, size = struct.unpack_from(order + "II", body, offset)
    if first >> 16:
        return first & 0xFFFF, offset + 4, min(first >> 16, 4)
    return first, offset + 8, size


def _read_text(body: memoryview, offset: int, order: str) -> tuple[str, int]:
    """A name, and where the next element begins."""
    kind, start, size = _read_tag(body, offset, order)
    if kind not in (1, 2, 16) or start + size > len(body):
        raise corrupt(f"a matrix has its name as type {kind} of {size} bytes")
    small = start == offset + 4
    return clean_name(bytes(body[start : start + size])), offset + 8 if small else _padded(start + size)
