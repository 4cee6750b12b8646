"""What the jobs of `benchmarks.expectations` are given: the body, its shells, and fields around it, made when first asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core.field_source import FieldData, FieldMesh, FieldTable
from core.io import canonical
from core.io.canonical_field import save_field
from core.mesh import Mesh
from core.schema.reference import MeshReference
from core.schema.shells import ShellsInputs
from core.shells.nested_shells import create_shells
from store.mesh_inputs import NUMBERS_PER_FACE
from subjects.body import body

HREFS = [f"/v1/meshes/00000000-0000-4000-8000-{number:012}" for number in range(1, 6)]
SKIN, FAT, AVERAGE_BODY, POINTS, TETRAHEDRA = HREFS
POINT_COUNT = 1_000_000
CELLS = (48, 96, 36)  # of a grid of cubes around the body, six tetrahedra each: 995,328
KUHN = ((1, 2), (1, 4), (2, 1), (2, 4), (4, 1), (4, 2))  # from corner 0 of a cube over two others to corner 7


@dataclass(frozen=True, slots=True)
class Given:
    """A stored input, and how many faces the job is sized by for it."""

    path: Path
    faces: int


class Inputs:
    """Of one size of the body, in a folder."""

    def __init__(self, level: int, folder: Path) -> None:
        self._level, self._folder = level, folder
        self._made: dict[str, Given] = {}
        self.skin = body(level)

    def of(self, asked: Mapping[str, Any]) -> dict[str, Given]:
        """All that the inputs of a job refer to."""
        return {href: self._given(href) for href in HREFS if href in str(asked)}

    def _given(self, href: str) -> Given:
        if href not in self._made:
            make: dict[str, Callable[[], object]] = {
                SKIN: lambda: self._keep_mesh(SKIN, self.skin),
                FAT: self._make_shells,
                AVERAGE_BODY: self._make_shells,
                POINTS: self._make_points,
                TETRAHEDRA: self._make_tetrahedra,
            }
            make[href]()
        return self._made[href]

    def _keep_mesh(self, href: str, mesh: Mesh) -> None:
        canonical.save(mesh, self._path(href))
        self._made[href] = Given(self._path(href), len(mesh.faces))

    def _make_shells(self) -> None:
        shells = create_shells(self.skin, ShellsInputs(skin=MeshReference(href=SKIN)))
        for href, shell in zip((FAT, AVERAGE_BODY), shells, strict=True):
            self._keep_mesh(href, shell.mesh)

    def _make_points(self) -> None:
        low, high = self.skin.vertices.min(axis=0), self.skin.vertices.max(axis=0)
        points = np.random.default_rng(1).uniform(low, high, (POINT_COUNT, 3))
        vertices = self.skin.vertices[: POINT_COUNT // 2]
        points[: len(vertices)] = vertices  # somewhere near
        table = FieldTable(("x", "y", "z", "Ex", "Ey", "Ez"), np.ascontiguousarray(np.hstack([points, points]).T), 1.0)
        save_field(table, self._path(POINTS))
        self._made[POINTS] = Given(self._path(POINTS), table.columns.size // NUMBERS_PER_FACE)

    def _make_tetrahedra(self) -> None:
        field = grid_field(self.skin, CELLS)
        save_field(field, self._path(TETRAHEDRA))
        numbers = field.nodes.size + field.tetrahedra.size + sum(each.values.size for each in field.data)
        self._made[TETRAHEDRA] = Given(self._path(TETRAHEDRA), numbers // NUMBERS_PER_FACE)

    def _path(self, href: str) -> Path:
        return self._folder / f"{self._level}-{href[-1]}"


def grid_field(around: Mesh, cells: tuple[int, int, int]) -> FieldMesh:
    """Cubes of Kuhn's six tetrahedra over the box of a surface, with E and magnE in each."""
    low, high = around.vertices.min(axis=0) - 1.0, around.vertices.max(axis=0) + 1.0
    axes = [np.linspace(low[k], high[k], cells[k] + 1) for k in range(3)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    strides = ((cells[1] + 1) * (cells[2] + 1), cells[2] + 1, 1)
    along = [np.arange(cells[k]) * strides[k] for k in range(3)]
    first = (along[0][:, None, None] + along[1][:, None] + along[2]).ravel()
    corner = [sum(strides[k] for k in range(3) if number >> k & 1) for number in range(8)]
    paths = [(corner[0], corner[a], corner[a | b], corner[7]) for a, b in KUHN]
    tetrahedra = np.concatenate([first[:, None] + np.array(path) for path in paths]).astype(np.int32)
    values = nodes[tetrahedra].mean(axis=1)
    magnitude = np.linalg.norm(values, axis=1, keepdims=True)
    data = (FieldData("E", "elements", values), FieldData("magnE", "elements", magnitude))
    return FieldMesh(nodes, np.empty((0, 3), np.int32), tetrahedra, data)
