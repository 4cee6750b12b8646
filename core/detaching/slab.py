"""The solid of air that opens a contact: a sheet with a thickness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.detaching.border import border_sides, outwards
from core.detaching.sheet import Sheet
from core.geometry.normals import vertex_normals
from core.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

FIRST, SECOND, END = range(3)  # walls: of part 1, of part 2, and the rim between them


@dataclass(frozen=True, eq=False, slots=True)
class Slab:
    """mesh: closed, outward. wall: (F,) FIRST, SECOND or END."""

    mesh: Mesh
    wall: Ints

    def walls(self) -> tuple[Mesh, ...]:
        """The three kinds of faces as surfaces of their own, in the order of their numbers."""
        return tuple(Mesh(self.mesh.vertices, self.mesh.faces[self.wall == number]) for number in range(3))


def thicken(sheet: Sheet, width_mm: float) -> Slab:
    """Both sides of the sheet moved apart by the width, and joined around its border by a blunt edge."""
    faces = sheet.faces.astype(np.int32)
    shift = 0.5 * width_mm * vertex_normals(sheet.vertices, faces)
    count = len(sheet.vertices)
    start, end = border_sides(sheet.faces).T
    tip = np.full(count, -1, dtype=np.int64)
    border = np.unique(start)
    tip[border] = 2 * count + np.arange(len(border))
    upper = _strip(start, end, tip[start], tip[end])
    lower = _strip(tip[start], tip[end], start + count, end + count)
    every = np.concatenate((faces, faces[:, ::-1].astype(np.int64) + count, upper, lower))
    wall = np.repeat((FIRST, SECOND, END), (len(faces), len(faces), len(upper) + len(lower)))
    tips = sheet.vertices[border] + 0.5 * width_mm * outwards(sheet.vertices, sheet.faces)[border]
    return Slab(Mesh.of(np.concatenate((sheet.vertices + shift, sheet.vertices - shift, tips)), every), wall)


def _strip(start: Ints, end: Ints, low_start: Ints, low_end: Ints) -> Ints:
    """Two triangles below each side of a border."""
    return np.concatenate((np.column_stack((start, low_start, low_end)), np.column_stack((start, low_end, end))))
