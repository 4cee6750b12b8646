"""`$NodeData` and `$ElementData` of gmsh files: the same in every version."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.field_source import Where
from core.io.msh_cursor import MshCursor, corrupt, counted, whole
from core.io.naming import clean_name

SECTIONS: dict[str, Where] = {"NodeData": "nodes", "ElementData": "elements"}
MOST_TAGS = 1000
MOST_COMPONENTS = 81


@dataclass(frozen=True, eq=False, slots=True)
class DataRows:
    """One quantity as the file has it: number of the node or element (N,), values (N, components)."""

    name: str
    where: Where
    ids: NDArray[np.int64]
    values: NDArray[np.float64]


def read_data(cursor: MshCursor, section: str) -> DataRows:
    """Raises: InputError `msh.corrupt`, `msh.truncated`, `msh.count_mismatch`."""
    words = [cursor.full_line() for _ in range(_few(cursor))]
    for _ in range(_few(cursor)):
        cursor.full_line()  # time and other real tags
    tags = [cursor.full_line() for _ in range(_few(cursor))]
    if len(tags) < 3:
        raise corrupt(f"a section {section} without its number of components and rows")
    name = clean_name(words[0].strip('"'), "data") if words else "data"
    components, count = counted(tags[1]), counted(tags[2])
    if not 1 <= components <= MOST_COMPONENTS:
        raise corrupt(f"data '{name}' with {components} components")
    ids, values = (_binary if cursor.binary else _text)(cursor, section, name, components, count)
    return DataRows(name, SECTIONS[section], ids, values)


def _binary(
    cursor: MshCursor, section: str, name: str, components: int, count: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    del section, name
    rows = cursor.rows(np.dtype([("id", f"{cursor.order}i4"), ("value", f"{cursor.order}f8", (components,))]), count)
    return rows["id"].astype(np.int64), rows["value"].astype(np.float64)


def _text(
    cursor: MshCursor, section: str, name: str, components: int, count: int
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    numbers = cursor.numbers(section)
    if len(numbers) != count * (1 + components):
        raise InputError(
            "msh.count_mismatch",
            f"data '{name}' announces {count} rows of {components} components, but has {len(numbers)} numbers",
            announced=count,
            numbers=len(numbers),
        )
    table = numbers.reshape(count, 1 + components)
    return whole(table[:, 0], f"numbers of data '{name}'"), np.ascontiguousarray(table[:, 1:])


def _few(cursor: MshCursor) -> int:
    count = cursor.count()
    if count > MOST_TAGS:
        raise corrupt(f"a section with {count} tags")
    return count
