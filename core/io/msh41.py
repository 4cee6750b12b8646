"""Nodes and elements of gmsh 4.1 files, text and binary: blocks by entity."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from core.io.msh_cursor import MshCursor, corrupt, truncated, whole
from core.io.msh_elements import ElementRows, nodes_of

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
SIZE_T = 8  # bytes of a count or number in binary files


class _Numbers:
    """One number after the other, whatever the file is in."""

    def __init__(self, cursor: MshCursor, name: str) -> None:
        self._cursor = cursor
        self._text = None if cursor.binary else cursor.numbers(name)
        self._at = 0

    def integers(self, count: int, size: int) -> Ints:
        """`count` whole numbers; `size` bytes each in a binary file."""
        if self._text is None:
            return self._cursor.integers(count, size)
        return whole(self.floats(count), "numbers of nodes and elements")

    def floats(self, count: int) -> Floats:
        """`count` numbers. Raises: InputError `msh.truncated`."""
        if self._text is None:
            return self._cursor.rows(np.dtype(f"{self._cursor.order}f8"), count).astype(np.float64)
        if count > len(self._text) - self._at:
            raise truncated(f"{count} numbers were announced, {len(self._text) - self._at} are left in the section")
        found = self._text[self._at : self._at + count]
        self._at += count
        return found


def read_nodes(cursor: MshCursor) -> tuple[Ints, Floats]:
    """Numbers (N,) and places (N, 3) in the file's unit. Raises: InputError `msh.corrupt`, `msh.truncated`."""
    numbers = _Numbers(cursor, "Nodes")
    blocks, count, _, _ = numbers.integers(4, SIZE_T)
    ids: list[Ints] = [np.empty(0, np.int64)]
    places: list[Floats] = [np.empty((0, 3))]

    def block() -> int:
        dimension, _, parametric = numbers.integers(3, 4)
        rows = _counted(numbers.integers(1, SIZE_T)[0])
        width = 3 + (int(dimension) if parametric else 0)
        if not 3 <= width <= 6:
            raise corrupt(f"an entity of dimension {dimension}")
        ids.append(numbers.integers(rows, SIZE_T))
        places.append(numbers.floats(rows * width).reshape(rows, width)[:, :3])
        return rows

    _read_blocks(_counted(blocks), _counted(count), block, "nodes")
    return np.concatenate(ids), np.concatenate(places)


def read_elements(cursor: MshCursor) -> list[ElementRows]:
    """In blocks of one type. Raises: InputError `msh.corrupt`, `msh.truncated`."""
    numbers = _Numbers(cursor, "Elements")
    blocks, count, _, _ = numbers.integers(4, SIZE_T)
    found: list[ElementRows] = []

    def block() -> int:
        _, _, type_ = numbers.integers(3, 4)
        rows = _counted(numbers.integers(1, SIZE_T)[0])
        width = 1 + nodes_of(int(type_))
        table = numbers.integers(rows * width, SIZE_T).reshape(rows, width)
        found.append(ElementRows(int(type_), table[:, 0], table[:, 1:]))
        return rows

    _read_blocks(_counted(blocks), _counted(count), block, "elements")
    return found


def _read_blocks(blocks: int, count: int, read: Callable[[], int], what: str) -> None:
    total = 0
    for _ in range(blocks):
        total += read()
    if total != count:
        raise corrupt(f"{count} {what} were announced, {total} are there")


def _counted(number: np.int64) -> int:
    if number < 0:
        raise corrupt(f"{number} stands where a number of things is wanted")
    return int(number)
