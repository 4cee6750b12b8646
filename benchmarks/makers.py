"""Ways to make shells inside a skin: ours, and what people use today."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec

import numpy as np
import pymeshlab

from benchmarks.level_set import offset_by_level_set
from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from core.shells.nested_shells import create_shells
from subjects.trial import shells_inputs

Depths = tuple[float, ...]
Maker = Callable[[Mesh, Depths], list[Mesh]]
VOXEL_MM = 2.0
CLOSER_GAP_MM = 0.02


def integument(skin: Mesh, depths_mm: Depths) -> list[Mesh]:
    """Geometry alone: no report, no proof."""
    return [shell.mesh for shell in create_shells(skin, shells_inputs(depths_mm))]


def integument_closer(skin: Mesh, depths_mm: Depths) -> list[Mesh]:
    """For many layers, which at the default gap may find no room in the thinnest parts."""
    return [shell.mesh for shell in create_shells(skin, shells_inputs(depths_mm, min_gap_mm=CLOSER_GAP_MM))]


def vertex_normal_offset(skin: Mesh, depths_mm: Depths) -> list[Mesh]:
    """Every vertex moved inwards along its normal."""
    normals = vertex_normals(skin.vertices, skin.faces, "area")
    return [skin.with_vertices(skin.vertices - depth * normals) for depth in depths_mm]


def pymeshlab_resampled_offset(skin: Mesh, depths_mm: Depths) -> list[Mesh]:
    """MeshLab's uniform resampling at an offset, decimated to the skin's number of faces."""
    made = []
    for depth in depths_mm:
        work = pymeshlab.MeshSet()
        work.add_mesh(pymeshlab.Mesh(skin.vertices, skin.faces))
        work.generate_resampled_uniform_mesh(
            cellsize=pymeshlab.PureValue(VOXEL_MM), offset=pymeshlab.PureValue(-depth), mergeclosevert=True, multisample=True
        )
        work.meshing_decimation_quadric_edge_collapse(targetfacenum=len(skin.faces))
        current = work.current_mesh()
        made.append(Mesh.of(current.vertex_matrix(), current.face_matrix()))
    return made


def level_set_offset(skin: Mesh, depths_mm: Depths) -> list[Mesh]:
    """Marching cubes of the signed distance (libigl), decimated to the skin's number of faces (MeshLab's quadrics)."""
    return [_decimated(offset_by_level_set(skin, depth, VOXEL_MM), len(skin.faces)) for depth in depths_mm]


def meshlib_offset(skin: Mesh, depths_mm: Depths) -> list[Mesh]:
    """MeshLib's voxel offset, decimated; only where somebody has installed it by hand."""
    mrmeshpy, mrmeshnumpy = (import_module(f"meshlib.{name}") for name in ("mrmeshpy", "mrmeshnumpy"))
    made = []
    for depth in depths_mm:
        settings = mrmeshpy.OffsetParameters()
        settings.voxelSize = 0.75
        shell = mrmeshpy.offsetMesh(mrmeshnumpy.meshFromFacesVerts(skin.faces, skin.vertices), -depth, settings)
        decimate = mrmeshpy.DecimateSettings()
        decimate.maxDeletedFaces = max(0, shell.topology.numValidFaces() - len(skin.faces))
        decimate.maxError = 1e3
        mrmeshpy.decimateMesh(shell, decimate)
        shell.pack()
        made.append(Mesh.of(mrmeshnumpy.getNumpyVerts(shell), mrmeshnumpy.getNumpyFaces(shell.topology)))
    return made


def _decimated(mesh: Mesh, faces: int) -> Mesh:
    work = pymeshlab.MeshSet()
    work.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.faces))
    work.meshing_decimation_quadric_edge_collapse(targetfacenum=faces, preservetopology=True)
    current = work.current_mesh()
    return Mesh.of(current.vertex_matrix(), current.face_matrix())


MAKERS: dict[str, Maker] = {
    "integument": integument,
    "vertex-normal offset": vertex_normal_offset,
    f"pymeshlab resampled offset {VOXEL_MM:g} mm, decimated": pymeshlab_resampled_offset,
    f"level set {VOXEL_MM:g} mm, decimated": level_set_offset,
}
if find_spec("meshlib") is not None:
    MAKERS["MeshLib voxel offset 0.75 mm, decimated"] = meshlib_offset
VARIANTS: dict[str, Maker] = {f"integument, min_gap_mm {CLOSER_GAP_MM:g}": integument_closer}


def warm_up(maker: Maker) -> None:
    """Compile kernels before the clock starts."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * 20.0
    squares = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    maker(Mesh.of(corners, [face for a, b, c, d in squares for face in ((a, b, c), (a, c, d))]), (1.0, 3.0))
