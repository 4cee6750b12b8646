"""The internal form of a field on disk: what the store keeps and jobs load. Equal fields give equal bytes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.field_source import FieldData, FieldMesh, FieldSource, FieldTable
from core.io.array_file import corrupt, read_arrays, write_arrays

MAGIC = b"INTFIELD"
ABOUT = "about"
DATA = "data:"


def save_field(field: FieldSource, path: Path) -> None:
    """Write the field."""
    if isinstance(field, FieldTable):
        about: dict[str, object] = {"names": field.names, "mm_per_unit": field.mm_per_unit}
        tables: dict[str, NDArray[np.generic]] = {"columns": field.columns}
    else:
        about = {"data": [[each.name, each.where] for each in field.data]}
        tables = {"nodes": field.nodes, "triangles": field.triangles, "tetrahedra": field.tetrahedra}
        tables |= {f"{DATA}{number}": each.values for number, each in enumerate(field.data)}
    text = json.dumps(about, separators=(",", ":")).encode()
    write_arrays(path, MAGIC, {ABOUT: np.frombuffer(text, np.uint8), **tables})


def load_field(path: Path) -> FieldSource:
    """Read it back; arrays are read-only. Raises: InternalError `canonical.corrupt`."""
    tables = read_arrays(path, MAGIC)
    try:
        about = json.loads(tables[ABOUT].tobytes())
        if "columns" in tables:
            return FieldTable(tuple(about["names"]), tables["columns"].astype(np.float64, copy=False), about["mm_per_unit"])
        data = tuple(
            FieldData(name, where, tables[f"{DATA}{number}"].astype(np.float64, copy=False))
            for number, (name, where) in enumerate(about["data"])
        )
        triangles, tetrahedra = (tables[name].astype(np.int32, copy=False) for name in ("triangles", "tetrahedra"))
        return FieldMesh(tables["nodes"].astype(np.float64, copy=False), triangles, tetrahedra, data)
    except (ValueError, TypeError, KeyError) as error:  # written by another version of this module
        raise corrupt(f"it does not describe a field: {error}") from error
