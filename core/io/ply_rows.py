"""The rows of one PLY element as columns.

In nearly every file all rows are as long as the first one; then they are read as one array, otherwise row by row.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.io.ply_header import Element, malformed

LONGEST_LIST = 100_000  # corners of a polygon; more is a damaged count
Numbers = NDArray[np.generic]


@dataclass(frozen=True, eq=False, slots=True)
class Column:
    """values of all rows, one after the other; counts (rows,) of a list property, None for plain numbers."""

    values: Numbers
    counts: NDArray[np.int64] | None = None


@dataclass(frozen=True, slots=True)
class Layout:
    """How one property lies in a row."""

    name: str
    type: np.dtype[np.generic]
    count_type: np.dtype[np.generic] | None


def as_doubles(element: Element) -> Element:
    """The same element with every number a double: an ASCII body is read as text into doubles first."""
    columns = (replace(c, type="f8", count_type=None if c.count_type is None else "f8") for c in element.properties)
    return replace(element, properties=tuple(columns))


def read_rows(data: bytes, offset: int, element: Element, order: str) -> tuple[dict[str, Column], int]:
    """Columns by name, and the offset of the byte after the last row; byte order "<", ">" or "=".

    Raises: InputError `ply.truncated`, `ply.malformed`. Nothing is allocated for rows the data cannot hold.
    """
    if element.count > len(data) - offset:  # a row has a byte at least
        raise _truncated(element, 0)
    layouts = [
        Layout(c.name, np.dtype(order + c.type), None if c.count_type is None else np.dtype(order + c.count_type))
        for c in element.properties
    ]
    if element.count == 0:
        return {each.name: _join([], None if each.count_type is None else []) for each in layouts}, offset
    first_row, end_of_first = _walk(data, offset, layouts, replace(element, count=1))
    lengths = {name: int(column.counts[0]) for name, column in first_row.items() if column.counts is not None}
    end = offset + (end_of_first - offset) * element.count
    if end <= len(data):
        rows = np.frombuffer(data, dtype=_row_type(layouts, lengths), count=element.count, offset=offset)
        if all((rows[f"count of {name}"] == length).all() for name, length in lengths.items()):
            return {each.name: _even_column(rows[f"value of {each.name}"], lengths.get(each.name)) for each in layouts}, end
    elif not lengths:
        raise _truncated(element, (len(data) - offset) // (end_of_first - offset))
    return _walk(data, offset, layouts, element)


def _truncated(element: Element, held: int) -> InputError:
    message = f"the file ends inside element '{element.name}': {element.count} rows declared, {held} found"
    return InputError("ply.truncated", message, declared=element.count, held=held)


def _row_type(layouts: list[Layout], lengths: dict[str, int]) -> np.dtype[np.void]:
    fields: list[tuple[str, np.dtype[np.generic]] | tuple[str, np.dtype[np.generic], tuple[int]]] = []
    for each in layouts:
        if each.count_type is None:
            fields.append((f"value of {each.name}", each.type))
        else:
            fields += [(f"count of {each.name}", each.count_type), (f"value of {each.name}", each.type, (lengths[each.name],))]
    return np.dtype(fields)


def _even_column(values: Numbers, length: int | None) -> Column:
    if length is None:
        return Column(values)
    return Column(values.reshape(-1), np.full(len(values), length, dtype=np.int64))


def _walk(data: bytes, offset: int, layouts: list[Layout], element: Element) -> tuple[dict[str, Column], int]:
    """Read row by row."""
    parts: dict[str, list[Numbers]] = {each.name: [] for each in layouts}
    counts: dict[str, list[int]] = {each.name: [] for each in layouts if each.count_type is not None}
    for row in range(element.count):
        for each in layouts:
            length = 1
            if each.count_type is not None:
                length = _list_length(_take(data, offset, each.count_type, 1, element, row).item(), element, row)
                offset += each.count_type.itemsize
                counts[each.name].append(length)
            parts[each.name].append(_take(data, offset, each.type, length, element, row))
            offset += each.type.itemsize * length
    return {name: _join(part, counts.get(name)) for name, part in parts.items()}, offset


def _take(data: bytes, offset: int, kind: np.dtype[np.generic], length: int, element: Element, row: int) -> Numbers:
    if offset + kind.itemsize * length > len(data):
        raise _truncated(element, row)
    return np.frombuffer(data, kind, length, offset)


def _list_length(value: float, element: Element, row: int) -> int:
    if not (0 <= value <= LONGEST_LIST and value == int(value)):
        raise malformed(f"row {row} of element '{element.name}' has a list of {value:g} entries", row=row)
    return int(value)


def _join(parts: list[Numbers], counts: list[int] | None) -> Column:
    values = np.concatenate(parts) if parts else np.empty(0)
    return Column(values, None if counts is None else np.array(counts, dtype=np.int64))
