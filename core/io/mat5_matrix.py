"""The head of one matrix in a MAT file of version 5: class, dimensions, name, and where the numbers begin."""

from __future__ import annotations

import struct
from dataclasses import dataclass

from core.errors import InputError
from core.io.mat_variable import NUMBER_CLASSES
from core.io.naming import clean_name

INT8, UINT8, INT32, UINT32, UTF8 = 1, 2, 5, 6, 16  # type numbers of the parts
NUMBER_CLASS_CODES = {6: "double", 7: "single", 8: "int8", 9: "uint8", 10: "int16", 11: "uint16", 12: "int32", 13: "uint32"}
LONG_CLASS_CODES = {14: "int64", 15: "uint64"}
OTHER_CLASS_CODES = {1: "cell", 2: "struct", 3: "object", 4: "char", 5: "sparse", 16: "function_handle", 17: "opaque"}
CLASSES = NUMBER_CLASS_CODES | LONG_CLASS_CODES | OTHER_CLASS_CODES
COMPLEX, LOGICAL = 0x08, 0x02


def corrupt(message: str, **facts: int) -> InputError:
    """The error for a MAT file that breaks its own rules."""
    error = InputError("mat.corrupt", message)
    error.facts.update(facts)
    return error


@dataclass(frozen=True, slots=True)
class MatrixHead:
    """`numbers_at`: offset of the numbers in the matrix element; 0 for an opaque object, which has none."""

    name: str
    matlab_class: str
    shape: tuple[int, ...]
    numbers_at: int


def parse_head(body: memoryview, order: str) -> MatrixHead:
    """Read the parts before the numbers; `order` is "<" or ">". Raises: InputError `mat.corrupt`."""
    kind, start, size = read_tag(body, 0, order)
    if kind != UINT32 or size != 8:
        raise corrupt(f"a matrix begins with type {kind} of {size} bytes, array flags expected")
    if start + size > len(body):
        raise corrupt(f"a matrix of {len(body)} bytes ends in its flags")
    flags = struct.unpack_from(order + "I", body, start)[0]
    number, bits = flags & 0xFF, flags >> 8
    if number not in CLASSES:
        raise corrupt(f"a matrix has class {number}", matlab_class=number)
    if CLASSES[number] == "opaque":  # has no dimensions; the name follows at once
        return MatrixHead(_read_text(body, start + size, order)[0], "opaque", (), 0)
    kind, shape_start, shape_size = read_tag(body, start + size, order)
    if kind != INT32 or shape_size % 4 or shape_size < 8 or shape_start + shape_size > len(body):
        raise corrupt(f"a matrix has its dimensions as type {kind} of {shape_size} bytes")
    shape = struct.unpack_from(f"{order}{shape_size // 4}i", body, shape_start)
    if min(shape) < 0:
        raise corrupt(f"a matrix has the dimensions {shape[:8]}")
    name, numbers_at = _read_text(body, _padded(shape_start + shape_size), order)
    return MatrixHead(name, _class_name(number, bits), shape, numbers_at)


def read_tag(body: memoryview, offset: int, order: str) -> tuple[int, int, int]:
    """Type, first byte and size of the part at `offset`; up to four bytes may share the tag."""
    if offset + 8 > len(body):
        raise corrupt(f"a matrix of {len(body)} bytes ends before its parts do", bytes=len(body))
    first, size = struct.unpack_from(order + "II", body, offset)
    if first >> 16:
        return first & 0xFFFF, offset + 4, min(first >> 16, 4)
    return first, offset + 8, size


def _class_name(number: int, bits: int) -> str:
    name = CLASSES[number]
    if bits & LOGICAL:
        return "logical"
    return f"complex {name}" if bits & COMPLEX and name in NUMBER_CLASSES else name


def _padded(offset: int) -> int:
    """Elements inside a matrix begin at multiples of 8 bytes."""
    return -(-offset // 8) * 8


def _read_text(body: memoryview, offset: int, order: str) -> tuple[str, int]:
    """A name, and where the next element begins."""
    kind, start, size = read_tag(body, offset, order)
    if kind not in (INT8, UINT8, UTF8) or start + size > len(body):
        raise corrupt(f"a matrix has its name as type {kind} of {size} bytes")
    small = start == offset + 4
    return clean_name(bytes(body[start : start + size])), offset + 8 if small else _padded(start + size)
