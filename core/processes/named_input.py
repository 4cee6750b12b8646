"""A mesh that a job refers to, loaded by its link."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, InternalError
from core.io import canonical
from core.io.registry import read_meshes
from core.mesh import Mesh
from core.schema.reference import CANONICAL_MEDIA_TYPE


@dataclass(frozen=True, eq=False, slots=True)
class NamedInput:
    """sha256 is of the stored bytes, so a report can say exactly what went in. arrays: name -> (V,) of the upload."""

    name: str
    mesh: Mesh
    sha256: str
    arrays: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)


def load_input(href: str, meshes: Mapping[str, Mapping[str, Any]]) -> NamedInput:
    """Load from the canonical form of an upload, or from the STL of an earlier job.

    Raises: InputError `reference.not_a_mesh`; InternalError `reference.unresolved`, `canonical.corrupt`.
    """
    entry = meshes.get(href)
    if entry is None:
        raise InternalError("reference.unresolved", f"{href} was accepted but not resolved", href=href)
    path = Path(entry["path"])
    if entry.get("media_type", CANONICAL_MEDIA_TYPE) == CANONICAL_MEDIA_TYPE:
        mesh, arrays = canonical.load_with_arrays(path)
        return NamedInput(
            entry["name"], mesh, entry["sha256"], {name: values.astype(np.float64) for name, values in arrays.items()}
        )
    read = read_meshes(path, file_name=entry["file_name"], unit="mm").meshes
    if len(read) != 1:
        raise InputError("reference.not_a_mesh", f"{href} holds {len(read)} meshes; one is wanted", href=href)
    return NamedInput(entry["name"], read[0].mesh, entry["sha256"])
