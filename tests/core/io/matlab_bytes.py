"""MAT files of version 5 put together by hand, for what SciPy cannot write: functions, objects, wrong sizes."""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import ArrayLike

DOUBLE, FUNCTION, OPAQUE, OBJECT, CHAR = 6, 16, 17, 3, 4
INT8, INT32, UINT32, DOUBLES, MATRIX, COMPRESSED = 1, 5, 6, 9, 14, 15


def mat_file(*elements: bytes, order: str = "<") -> bytes:
    """A header and the elements."""
    text = b"MATLAB 5.0 MAT-file, by hand".ljust(124)
    return text + struct.pack(order + "H", 0x0100) + (b"IM" if order == "<" else b"MI") + b"".join(elements)


def element(kind: int, content: bytes, order: str = "<") -> bytes:
    """Tag, content, padding."""
    return struct.pack(order + "II", kind, len(content)) + content + b"\0" * (-len(content) % 8)


def matrix(
    name: str, numbers: ArrayLike, *, shape: tuple[int, ...] | None = None, flags: int = DOUBLE, order: str = "<"
) -> bytes:
    """A matrix of doubles; `shape` and `flags` may lie."""
    array = np.asarray(numbers, dtype=order + "f8")
    data = element(DOUBLES, array.tobytes(order="F"), order)
    return element(MATRIX, head(name, shape or array.shape, flags, order) + data, order)


def head(name: str, shape: tuple[int, ...], flags: int, order: str = "<") -> bytes:
    """Flags, dimensions and name of a matrix."""
    sizes = struct.pack(f"{order}{len(shape)}i", *shape)
    flag_words = struct.pack(order + "II", flags, 0)
    return element(UINT32, flag_words, order) + element(INT32, sizes, order) + element(INT8, name.encode(), order)


def function_handle(name: str) -> bytes:
    """What `f = @(x) x` leaves in a file: class 16, 1 x 1, and the struct behind it."""
    return element(MATRIX, head(name, (1, 1), FUNCTION) + matrix("", [[0.0]]))


def opaque_object(name: str) -> bytes:
    """What a string, a table or any classdef object leaves: class 17, no size, name, type system, class name."""
    names = [element(INT8, text.encode()) for text in (name, "MCOS", "string")]
    return element(MATRIX, element(UINT32, struct.pack("<II", OPAQUE, 0)) + b"".join(names))


def compressed(whole: bytes) -> bytes:
    """An element as version 7 packs it; not padded."""
    packed = zlib.compress(whole)
    return struct.pack("<II", COMPRESSED, len(packed)) + packed
