"""Binary STL: 80 header bytes, a uint32 count, 50 bytes per facet. Float32, no connectivity, no unit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.errors import InputError
from core.geometry.normals import face_normals
from core.io.naming import clean_name
from core.io.reading import Piece
from core.io.welding import weld
from core.mesh import Mesh

HEADER_BYTES = 80
PREFIX_BYTES = 84
FACET = np.dtype([("normal", "<f4", (3,)), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def file_size(count: int) -> int:
    """Bytes of a file with `count` facets; any other size is wrong."""
    return PREFIX_BYTES + FACET.itemsize * count


def declared_count(prefix: bytes) -> int:
    """The count in the first 84 bytes."""
    return int.from_bytes(prefix[HEADER_BYTES:PREFIX_BYTES], "little")


def size_error(size: int, count: int) -> InputError:
    """The error for a file of `size` bytes whose header declares `count` facets: cut off, or a count that is not true."""
    if size < PREFIX_BYTES:
        return InputError("stl.truncated", f"the file has {size} bytes, a binary STL needs at least {PREFIX_BYTES}", bytes=size)
    held, remainder = divmod(size - PREFIX_BYTES, FACET.itemsize)
    numbers = f"the header declares {count} facets ({file_size(count)} bytes), the file has {size} bytes"
    if remainder and held < count:
        return InputError(
            "stl.truncated", f"{numbers}: it ends inside facet {held} (from 0)", declared=count, held=held, bytes=size
        )
    return InputError("stl.count_mismatch", f"{numbers}, which hold {held} facets", declared=count, held=held, bytes=size)


def read_facets(path: Path, count: int) -> Piece:
    """Read `count` facets and weld equal corners. Normals and attribute bytes of the file are not used: the winding counts."""
    facets = np.fromfile(path, dtype=FACET, count=count, offset=PREFIX_BYTES)
    vertices, index = weld(facets["corners"].reshape(-1, 3))
    return Piece("", vertices, index.reshape(-1, 3))


def write(mesh: Mesh, path: Path, name: str) -> None:
    """Write float32 facets with normals by the winding (zero for faces without area). Same mesh and name, same bytes.

    Coordinates are rounded to float32: prove `mesh.rounded_to_float32()`, not its parent.
    """
    facets = np.zeros(len(mesh.faces), dtype=FACET)
    facets["corners"] = mesh.vertices.astype(np.float32)[mesh.faces]
    facets["normal"] = face_normals(mesh.vertices, mesh.faces)
    # never begins with "solid", which some readers take for ASCII
    header = f"Integument binary STL, millimetres, {clean_name(name)}".encode("ascii", errors="replace")
    with path.open("wb") as file:
        file.write(header[:HEADER_BYTES].ljust(HEADER_BYTES))
        file.write(len(mesh.faces).to_bytes(4, "little"))
        facets.tofile(file)
