"""Compile and load all kernels before the first job, so that every child finds them in memory."""

from __future__ import annotations

from core.mesh import Mesh
from core.schema.reference import MeshReference
from core.schema.shells import Layer, ShellsInputs
from core.shells.nested_shells import create_shells
from core.validation.validate import validate

SIZE_MM = 100.0
CUBE_CORNERS = [(x, y, z) for x in (0.0, SIZE_MM) for y in (0.0, SIZE_MM) for z in (0.0, SIZE_MM)]
CUBE_FACES = [
    (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
    (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
]  # fmt: skip


def warm_up() -> None:
    """Run the main job on a cube, which passes through every compiled kernel."""
    cube = Mesh.of(CUBE_CORNERS, CUBE_FACES)
    inputs = ShellsInputs(
        skin=MeshReference(href="/v1/meshes/00000000-0000-0000-0000-000000000000"),
        layers=(Layer(name="outer", depth_mm=1.0), Layer(name="inner", depth_mm=2.0)),
    )
    shells = create_shells(cube, inputs)
    validate({"cube": cube, **{shell.name: shell.mesh for shell in shells}})
