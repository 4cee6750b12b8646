"""gmsh files, .msh 2.2 and 4.1, text and binary: nodes, triangles, tetrahedra and the data on them.

Written here: meshio pairs data with elements by their place in the file and not by their numbers, and reads text line by line.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from mmap import ACCESS_READ, mmap
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.field_source import FieldData, FieldMesh
from core.io import msh22, msh41
from core.io.msh_cursor import MshCursor, corrupt, truncated
from core.io.msh_data import SECTIONS, DataRows, read_data
from core.io.msh_elements import TETRAHEDRON, TRIANGLE, ElementRows, of_type
from core.io.naming import clean_name, make_unique
from core.io.unit import MM_PER_UNIT, Unit
from core.mesh import LARGEST_COORDINATE_MM
from core.schema.finding import Finding, Severity

SIGNATURE = b"$MeshFormat"
COMPONENTS = (1, 3)

Ints = NDArray[np.int64]
Nodes = tuple[Ints, NDArray[np.float64]]  # numbers and places


@dataclass(frozen=True, slots=True)
class _Version:
    """How one version of the format has its nodes and elements."""

    read_nodes: Callable[[MshCursor], Nodes]
    read_elements: Callable[[MshCursor], list[ElementRows]]


VERSION_2 = _Version(msh22.read_nodes, msh22.read_elements)
VERSIONS = {**dict.fromkeys(("2", "2.1", "2.2"), VERSION_2), "4.1": _Version(msh41.read_nodes, msh41.read_elements)}


def read_msh(path: Path, unit: Unit) -> tuple[FieldMesh, tuple[Finding, ...]]:
    """All of it in mm, and what was left out.

    Raises: InputError `msh.corrupt`, `msh.truncated`, `msh.unsupported`, `msh.no_nodes`, `msh.no_data`, `msh.duplicate_id`,
    `msh.unknown_id`, `msh.count_mismatch`, `msh.not_finite`.
    """
    if not path.stat().st_size:  # nothing cannot be mapped
        raise truncated("it is empty")
    with path.open("rb") as file:
        data = mmap(file.fileno(), 0, access=ACCESS_READ)  # not closed by hand: an error on its way out may hold a view of it
    nodes, elements, rows = _read_sections(MshCursor(data))
    ids, places = nodes
    order, ids = _sorted(ids, "node")
    places = _require_places(places[order], unit)
    kinds = [of_type(elements, kind) for kind in (TRIANGLE, TETRAHEDRON)]
    of_elements, counts = np.concatenate([kind.ids for kind in kinds]), [len(kind.ids) for kind in kinds]
    others = np.concatenate([np.empty(0, np.int64), *(each.ids for each in elements if each.type not in (TRIANGLE, TETRAHEDRON))])
    found = _Numbered(ids, of_elements, others, counts)
    used = [each for each in rows if each.values.shape[1] in COMPONENTS]
    names = make_unique(each.name for each in used)
    kept = tuple(FieldData(name, each.where, found.spread(each)) for name, each in zip(names, used, strict=True))
    if not kept:
        raise InputError("msh.no_data", "the file has no NodeData or ElementData of 1 or 3 components: there is no field in it")
    corners = [_index(ids, kind.nodes, "elements refer to nodes").astype(np.int32) for kind in kinds]
    mesh = FieldMesh(places, corners[0], corners[1], kept)
    return mesh, _left_out(len(others), [each.name for each in rows if each not in used])


def _read_sections(cursor: MshCursor) -> tuple[Nodes, list[ElementRows], list[DataRows]]:
    nodes: Nodes | None = None
    elements: list[ElementRows] = []
    data: list[DataRows] = []
    version = _read_format(cursor)
    while (section := cursor.next_section()) is not None:
        if section == "Nodes" and nodes is None:
            nodes = version.read_nodes(cursor)
        elif section == "Elements":
            elements += version.read_elements(cursor)
        elif section in SECTIONS:
            data.append(read_data(cursor, section))
        else:
            cursor.skip_section(section)
            continue
        cursor.end_section(section)
    if nodes is None or not len(nodes[0]):
        raise InputError("msh.no_nodes", "the gmsh file has no nodes")
    return nodes, elements, data


def _read_format(cursor: MshCursor) -> _Version:
    if cursor.next_section() != "MeshFormat":
        raise corrupt("it does not begin with $MeshFormat")
    words = cursor.full_line().split()
    if len(words) != 3 or words[0] not in VERSIONS or words[1] not in ("0", "1") or (words[1] == "1" and words[2] != "8"):
        told = clean_name(" ".join(words))[:40]
        raise InputError(
            "msh.unsupported", f"the file is of format '{told}'; read are 2.2 and 4.1, as text or with 8 bytes a number"
        )
    cursor.binary = words[1] == "1"
    if cursor.binary:
        one = cursor.rows(np.dtype("<i4"), 1)[0]
        if one not in (1, 1 << 24):
            raise corrupt(f"the mark of the order of bytes is {one}")
        cursor.order = "<" if one == 1 else ">"
    cursor.end_section("MeshFormat")
    return VERSIONS[words[0]]


class _Numbered:
    """Rows of the mesh by the numbers that nodes and elements have in the file."""

    def __init__(self, nodes: Ints, elements: Ints, others: Ints, counts: list[int]) -> None:
        self._nodes = nodes  # ascending
        self._order, self._elements = _sorted(elements, "element")
        self._others = others
        self._counts = counts

    def spread(self, data: DataRows) -> NDArray[np.float64]:
        """A row per node or per triangle and tetrahedron; NaN where the data has none.

        Raises: InputError `msh.unknown_id`, `msh.duplicate_id`, `msh.count_mismatch`."""
        _sorted(data.ids, f"row of '{data.name}' for node or element")
        what = f"data '{data.name}' refers to {data.where}"
        if data.where == "nodes":
            rows, values, size = _index(self._nodes, data.ids, what), data.values, len(self._nodes)
        else:
            foreign = np.isin(data.ids, self._others)
            ids, values, size = data.ids[~foreign], data.values[~foreign], len(self._elements)
            rows = self._order[_index(self._elements, ids, what)]
        self._require_whole(data, rows)
        spread = np.full((size, values.shape[1]), np.nan)
        spread[rows] = values
        return spread

    def _require_whole(self, data: DataRows, rows: Ints) -> None:
        """Values for some nodes, or for some triangles but not all, are those of another mesh."""
        if data.where == "nodes":
            complete = len(rows) == len(self._nodes)
            there = f"{len(self._nodes)} nodes"
        else:
            triangles = int((rows < self._counts[0]).sum())
            told = (triangles, len(rows) - triangles)
            complete = len(rows) > 0 and all(has in (0, wanted) for has, wanted in zip(told, self._counts, strict=True))
            there = f"{self._counts[0]} triangles and {self._counts[1]} tetrahedra"
        if not complete:
            raise InputError(
                "msh.count_mismatch", f"data '{data.name}' has {len(rows)} rows for them; the mesh has {there}", rows=len(rows)
            )


def _sorted(ids: Ints, what: str) -> tuple[Ints, Ints]:
    """Order (N,) and the numbers in it. Raises: InputError `msh.duplicate_id`."""
    order = np.argsort(ids, kind="stable")
    ascending = ids[order]
    twice = np.flatnonzero(ascending[1:] == ascending[:-1])
    if len(twice):
        raise InputError("msh.duplicate_id", f"{what} {ascending[twice[0]]} is there twice, {len(twice)} such", count=len(twice))
    return order, ascending


def _index(ascending: Ints, ids: Ints, what: str) -> Ints:
    """Where each of `ids` is. Raises: InputError `msh.unknown_id`."""
    places = np.searchsorted(ascending, ids)
    known = places < len(ascending)
    known[known] = ascending[places[known]] == ids[known]
    if not known.all():
        first = int(ids[~known].ravel()[0])
        raise InputError(
            "msh.unknown_id", f"{what} that are not there, {int((~known).sum())} times, first number {first}", first=first
        )
    return places


def _require_places(places: NDArray[np.float64], unit: Unit) -> NDArray[np.float64]:
    limit = LARGEST_COORDINATE_MM / MM_PER_UNIT[unit]
    bad = ~(np.abs(places) <= limit).all(axis=1)
    if bad.any():
        raise InputError(
            "msh.not_finite", f"{int(bad.sum())} nodes have coordinates that are NaN, infinite or beyond {limit:g} {unit}"
        )
    return places * MM_PER_UNIT[unit]


def _left_out(elements: int, data: list[str]) -> tuple[Finding, ...]:
    findings = []
    if elements:
        message = f"{elements} elements that are neither triangles nor tetrahedra of first order were left out"
        findings.append(Finding(code="msh.elements_left_out", severity=Severity.INFO, message=message, count=elements))
    if data:
        message = f"data with neither 1 nor 3 components was left out: {', '.join(data[:10])}"
        findings.append(Finding(code="msh.data_left_out", severity=Severity.INFO, message=message, count=len(data)))
    return tuple(findings)
