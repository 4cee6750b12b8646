"""The internal form of a mesh on disk: what the store keeps and jobs load. Equal meshes give equal bytes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.io.array_file import corrupt, read_arrays, write_arrays
from core.mesh import Mesh

MAGIC = b"INTMESH1"
PER_VERTEX = "vertex:"


def save(mesh: Mesh, path: Path, arrays: Mapping[str, NDArray[np.float64] | NDArray[np.int32]] | None = None) -> None:
    """Write the mesh and, by name, arrays with one row per vertex (V, ...), float64 or int32."""
    tables: dict[str, NDArray[np.generic]] = {"vertices": mesh.vertices, "faces": mesh.faces}
    for name, values in sorted((arrays or {}).items()):
        if len(values) != len(mesh.vertices) or values.dtype not in (np.float64, np.int32):
            raise ValueError(
                f"array {name} has shape {values.shape} and type {values.dtype}; a row per vertex, float64 or int32, wanted"
            )
        tables[PER_VERTEX + name] = values
    write_arrays(path, MAGIC, tables)


def load(path: Path) -> Mesh:
    """Read the mesh alone. Raises: InternalError `canonical.corrupt`."""
    return load_with_arrays(path)[0]


def load_with_arrays(path: Path) -> tuple[Mesh, dict[str, NDArray[np.generic]]]:
    """Read the mesh and its per-vertex arrays (read-only). Raises: InternalError `canonical.corrupt`."""
    tables = read_arrays(path, MAGIC)
    try:
        mesh = Mesh.of(tables.pop("vertices"), tables.pop("faces"))
    except (ValueError, TypeError, KeyError, InputError) as error:  # written by another version of this module
        raise corrupt(f"its directory does not describe a mesh: {error}") from error
    return mesh, {name.removeprefix(PER_VERTEX): values for name, values in tables.items()}
