"""What a worker does once so that no job waits for it: kernels are compiled, libraries loaded, for all children to come."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from core.decimation.decimate import decimate
from core.fields.containing import TetrahedronTree
from core.geometry.clearance import Clearance, MovingSurface
from core.grafting.band import triangulate_band
from core.healing.heal import heal
from core.mesh import Mesh
from core.processes.software import software_digest
from core.reports.figures.compose import draw_mesh_figures
from core.schema.decimate import DecimateInputs
from core.schema.heal import HealParameters
from core.schema.reference import MeshReference
from core.schema.separate import SeparateInputs
from core.schema.shells import Layer, ShellsInputs
from core.schema.smooth import SmoothInputs
from core.separation.separate import separate
from core.shells.nested_shells import create_shells
from core.shells.reconnect import Remedy, reconnect
from core.shells.sheet import Sheet
from core.smoothing.smooth import smooth
from core.validation.validate import validate

SIZE_MM = 100.0
PINCH = 0.025  # a plate of 2.5 mm: thin enough to call on the corrections, too
CUBE_CORNERS = [(x, y, z) for x in (0.0, SIZE_MM) for y in (0.0, SIZE_MM) for z in (0.0, SIZE_MM)]
CUBE_FACES = [
    (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
    (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
]  # fmt: skip
ANY_MESH = MeshReference(href="/v1/meshes/00000000-0000-0000-0000-000000000000")


def warm_up_steps() -> Sequence[Callable[[], object]]:
    """One per family of kernels, what is asked for most often first. Each alone compiles what it needs."""
    return (_shells, _mending_of_poor_faces, _healing, _decimation, _smoothing, _separation, _grafting, _fields, software_digest)


def warm_up() -> None:
    """All of it at once."""
    for step in warm_up_steps():
        step()


def _cube() -> Mesh:
    return Mesh.of(CUBE_CORNERS, CUBE_FACES)


def _shells() -> None:
    """The main job on a cube and on a plate, checked and drawn."""
    cube = _cube()
    inputs = ShellsInputs(skin=ANY_MESH, layers=(Layer(name="outer", depth_mm=1.0), Layer(name="inner", depth_mm=2.0)))
    surfaces = {"cube": cube, **{shell.name: shell.mesh for shell in create_shells(cube, inputs)}}
    validate(surfaces)
    draw_mesh_figures(surfaces)
    pinched = cube.with_vertices(cube.vertices * (1.0, 1.0, PINCH))
    create_shells(pinched, inputs.model_copy(update={"layers": (Layer(name="outer", depth_mm=1.0),)}))


def _mending_of_poor_faces() -> None:
    """No face of a cube is poor, so these are called by name."""
    cube = _cube()
    sheet = Sheet.copy_of(cube.vertices, cube.faces)
    everything = Remedy(flip_below=2.0, collapse_below=2.0)
    innate = np.full(len(cube.vertices), 2.0)
    reconnect(sheet, MovingSurface(cube.vertices, cube.faces), Clearance(0.0, 0.0, ()), everything, innate)


def _healing() -> None:
    cube = _cube()
    other = cube.vertices + 0.4 * SIZE_MM
    crossing = Mesh.of(np.vstack((cube.vertices, other)), np.vstack((cube.faces[2:], cube.faces + len(cube.vertices))))
    heal(crossing, HealParameters(max_volume_change=1.0, max_area_change=1.0, max_deviation_mm=1000.0))


def _decimation() -> None:
    for target in ({"target_faces": 10}, {"max_deviation_mm": 1.0}, {"target_faces": 10, "literal": True}):
        decimate({"cube": _cube()}, DecimateInputs.model_validate({"mesh": ANY_MESH, **target}))


def _smoothing() -> None:
    for method in ("wcc", "taubin"):
        smooth({"cube": _cube()}, SmoothInputs(mesh=ANY_MESH, method=method, retriangulate=True))


def _separation() -> None:
    cube = _cube()
    neighbours = {"cube": cube, "neighbour": cube.with_vertices(cube.vertices + np.array([SIZE_MM, 0.0, 0.0]))}
    separate(neighbours, SeparateInputs(meshes=dict.fromkeys(neighbours, ANY_MESH)))


def _grafting() -> None:
    vertices = _cube().vertices
    triangulate_band(vertices[[0, 4, 6, 2]], vertices[[1, 5, 7, 3]])


def _fields() -> None:
    """A point asked for in a tetrahedron; the distances to triangles are compiled with what all checks need."""
    corners = np.array([CUBE_CORNERS[corner] for corner in (0, 1, 2, 4)])
    TetrahedronTree.of(corners[None]).find(corners.mean(axis=0)[None])


if __name__ == "__main__":  # `make kernels`
    warm_up()
