"""Nodes and elements of gmsh 2.2 files, text and binary; SimNIBS writes the latter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.io.msh_cursor import MshCursor, corrupt, counted, truncated, whole
from core.io.msh_elements import ElementRows, count_alike, nodes_of

Ints = NDArray[np.int64]
MOST_TAGS = 1000


def read_nodes(cursor: MshCursor) -> tuple[Ints, NDArray[np.float64]]:
    """Numbers (N,) and places (N, 3) in the file's unit. Raises: InputError `msh.corrupt`, `msh.truncated`."""
    if cursor.binary:
        count = cursor.count()
        rows = cursor.rows(np.dtype([("id", f"{cursor.order}i4"), ("place", f"{cursor.order}f8", 3)]), count)
        return rows["id"].astype(np.int64), rows["place"].astype(np.float64)
    numbers = cursor.numbers("Nodes")
    count = int(numbers[0]) if len(numbers) and numbers[0] >= 0 else -1
    if len(numbers) != 1 + 4 * count:
        raise corrupt(f"{count} nodes were announced, {len(numbers)} numbers are there")
    table = numbers[1:].reshape(-1, 4)
    return whole(table[:, 0], "numbers of nodes"), np.ascontiguousarray(table[:, 1:])


def read_elements(cursor: MshCursor) -> list[ElementRows]:
    """In runs of one type. Raises: InputError `msh.corrupt`, `msh.truncated`."""
    return _binary_elements(cursor) if cursor.binary else _text_elements(cursor)


def _text_elements(cursor: MshCursor) -> list[ElementRows]:
    """Rows of number, type, number of tags, tags, nodes."""
    numbers = whole(cursor.numbers("Elements"), "elements")
    if not len(numbers):
        raise corrupt("section Elements is empty")
    left, at, found = int(numbers[0]), 1, []
    while left > 0:
        if at + 3 > len(numbers):
            raise truncated(f"{left} of {int(numbers[0])} elements are missing")
        type_, tags = int(numbers[at + 1]), _tags(int(numbers[at + 2]))
        stride = 3 + tags + nodes_of(type_)
        alike = count_alike(numbers, at, stride, (1, 2), left)
        if not alike:
            raise truncated(f"{left} of {int(numbers[0])} elements are missing")
        rows = numbers[at : at + alike * stride].reshape(alike, stride)
        found.append(ElementRows(type_, rows[:, 0], rows[:, 3 + tags :]))
        at, left = at + alike * stride, left - alike
    if at != len(numbers):
        raise corrupt(f"{len(numbers) - at} numbers follow the last of {int(numbers[0])} elements")
    return found


def _binary_elements(cursor: MshCursor) -> list[ElementRows]:
    """Blocks of type, number of elements, number of tags, and as many rows of number, tags, nodes; gmsh itself writes a block
    for every element."""
    total = cursor.count()
    left, found = total, []
    while left > 0:
        type_, count, tags = (int(number) for number in cursor.integers(3))
        nodes, tags = nodes_of(type_), _tags(tags)
        if not 1 <= count <= left:
            raise corrupt(f"a block of {count} elements, {left} of {total} are left")
        width = 1 + tags + nodes
        if count == 1:
            cursor.at -= 12
            alike = _blocks_alike(cursor, 3 + width, left)
            rows = cursor.integers(alike * (3 + width)).reshape(alike, 3 + width)[:, 3:]
        else:
            rows = cursor.integers(count * width).reshape(count, width)
        found.append(ElementRows(type_, rows[:, 0], rows[:, 1 + tags :]))
        left -= len(rows)
    return found


def _blocks_alike(cursor: MshCursor, stride: int, most: int) -> int:
    """Blocks of one element that follow each other and have the same header; at least 1."""
    there = min((len(cursor.data) - cursor.at) // 4, stride * most)
    ahead = np.frombuffer(cursor.data, f"{cursor.order}i4", there, cursor.at)
    alike = count_alike(ahead, 0, stride, (0, 1, 2), most)
    if not alike:
        raise truncated(f"the last of {most} elements are missing")
    return alike


def _tags(count: int) -> int:
    if not 0 <= count <= MOST_TAGS:
        raise corrupt(f"an element with {count} tags")
    return counted(str(count))
