"""PLY: ASCII and binary of both byte orders; polygons become fans. Written as binary little-endian with float64 coordinates."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.io.indexed import assemble
from core.io.naming import clean_name
from core.io.ply_header import Header, malformed, parse_header
from core.io.ply_rows import Column, as_doubles, read_rows
from core.io.polygons import check_polygons, fan
from core.io.reading import Reading
from core.mesh import Mesh

FACE = np.dtype([("count", "u1"), ("corners", "<i4", (3,))])
BYTE_ORDER = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "="}


def read(path: Path) -> Reading:
    """Read `vertex` (x, y, z) and `face` (vertex_indices or vertex_index); other columns and elements are passed over.

    Raises: InputError `ply.malformed`, `ply.truncated`, `mesh.empty`, `mesh.index_out_of_range`.
    """
    data = path.read_bytes()
    header = parse_header(data)
    tables = _read_elements(data, header)
    vertices, corners = tables.get("vertex"), _find_corners(tables)
    if vertices is None or not {"x", "y", "z"} <= vertices.keys() or any(vertices[axis].counts is not None for axis in "xyz"):
        raise malformed("the file has no element 'vertex' with the numbers x, y and z")
    if corners is None or corners.counts is None:
        raise malformed("the file has no element 'face' with a list 'vertex_indices'")
    counts = corners.counts
    if len(counts) and int(counts.min()) < 3:
        first = int(np.flatnonzero(counts < 3)[0])
        raise malformed(f"face {first} (from 0) has {int(counts[first])} corners, 3 are needed", face=first)
    points = np.column_stack([vertices[axis].values for axis in "xyz"])
    return assemble(points, fan(_to_indices(corners.values), counts), tuple(check_polygons(counts)), base=0)


def write(mesh: Mesh, path: Path, name: str) -> None:
    """Write all bits of the float64 coordinates. Same mesh and name, same bytes."""
    faces = np.empty(len(mesh.faces), dtype=FACE)
    faces["count"] = 3
    faces["corners"] = mesh.faces
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"comment Integument, millimetres, {clean_name(name)}\n"
        f"element vertex {len(mesh.vertices)}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    with path.open("wb") as file:
        file.write(header.encode("ascii", errors="replace"))
        mesh.vertices.astype("<f8", copy=False).tofile(file)
        faces.tofile(file)


def _read_elements(data: bytes, header: Header) -> dict[str, dict[str, Column]]:
    """All elements in file order; what follows the last one is not part of the format."""
    order, offset, elements = BYTE_ORDER[header.encoding], header.body, header.elements
    if header.encoding == "ascii":
        data, offset, elements = _numbers(data[offset:]).tobytes(), 0, tuple(map(as_doubles, elements))
    tables: dict[str, dict[str, Column]] = {}
    for element in elements:
        table, offset = read_rows(data, offset, element, order)
        tables.setdefault(element.name, table)
    if offset != len(data):
        raise malformed(f"{len(data) - offset} bytes follow the last element", bytes=len(data) - offset)
    return tables


def _numbers(text: bytes) -> NDArray[np.float64]:
    """All numbers of an ASCII body, native doubles."""
    words = text.split()
    if b"_" in text:  # Python reads 1_000, PLY does not know it
        raise malformed("the body has words that are no numbers")
    try:
        return np.fromiter(map(float, words), np.float64, len(words))
    except ValueError as error:
        raise malformed(f"the body has a word that is no number: {clean_name(str(error))}") from None


def _find_corners(tables: dict[str, dict[str, Column]]) -> Column | None:
    faces = tables.get("face", {})
    return faces.get("vertex_indices") or faces.get("vertex_index")


def _to_indices(values: NDArray[np.generic]) -> NDArray[np.int64]:
    """Corner numbers as int64; an ASCII body or a strange type may hold fractions, NaN or more than any file can index."""
    numbers = values.astype(np.float64)
    bad = ~(np.abs(numbers) < 2.0**53) | (numbers != np.floor(numbers))
    if bad.any():
        first = float(numbers[bad][0])
        raise InputError("ply.malformed", f"{int(bad.sum())} face indices are not whole numbers, the first is {first:g}")
    return numbers.astype(np.int64)
