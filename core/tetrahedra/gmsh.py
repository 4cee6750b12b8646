"""gmsh, told by their surfaces which space is which. It keeps surfaces as they are, as TetGen does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from core.tetrahedra.forked import Filling, MesherMissing, run_forked
from core.tetrahedra.spaces import Piece, Space

TRIANGLE, TETRAHEDRON = 2, 4  # gmsh's numbers of elements of first order
DELAUNAY = 1  # of its methods; HXT ends with memory broken and the frontal one not at all on layers of a body
OPTIONS = {"General.Terminal": 0, "General.NumThreads": 1, "Mesh.Algorithm3D": DELAUNAY, "Mesh.Optimize": 1}
SIZE = 0.65  # of the regular edge: then nine of ten tetrahedra are below the volume asked for, as with TetGen
DEBIAN_PACKAGES = "libglu1-mesa libgomp1 libxft2 libxcursor1 libxinerama1 libxfixes3"


def run_gmsh(
    vertices: NDArray[np.float64], pieces: Sequence[Piece], spaces: Sequence[Space], largest_mm3: Mapping[int, float]
) -> Filling:
    """Tetrahedra in all spaces, `region` that of `Space`; largest_mm3: region -> volume above which few tetrahedra are, where the
    surfaces allow it.

    Elsewhere edges are as long as those of the surfaces around. Raises: InputError `tetrahedra.refused` with what gmsh said,
    also if its process crashed; StateError `tetrahedra.no_mesher`.
    """
    return run_forked("gmsh", lambda: _fill(vertices, pieces, spaces, largest_mm3))


def _fill(
    vertices: NDArray[np.float64], pieces: Sequence[Piece], spaces: Sequence[Space], largest_mm3: Mapping[int, float]
) -> Filling:
    gmsh = _load()
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    for option, value in OPTIONS.items():
        gmsh.option.setNumber(option, value)
    _describe(gmsh, vertices, pieces, spaces)
    _limit_edges(gmsh, spaces, largest_mm3)
    gmsh.model.mesh.generate(3)
    return _result(gmsh, spaces)


def _load() -> ModuleType:
    """Here and not at the top: only the forked process needs its 100 MB."""
    try:
        import gmsh
    except (ImportError, OSError) as error:  # a library of X that it is linked with
        raise MesherMissing(f"{error}; `apt-get install {DEBIAN_PACKAGES}` brings what it needs of Debian") from error
    loaded: ModuleType = gmsh
    return loaded


def _describe(gmsh: ModuleType, vertices: NDArray[np.float64], pieces: Sequence[Piece], spaces: Sequence[Space]) -> None:
    """Its numbers count from 1: node n + 1 is vertex n, surface n + 1 piece n, volume n + 1 space n."""
    for number, piece in enumerate(pieces, 1):
        own = np.unique(piece.faces)
        gmsh.model.addDiscreteEntity(2, number)
        gmsh.model.mesh.addNodes(2, number, own + 1, vertices[own].ravel())
        gmsh.model.mesh.addElementsByType(number, TRIANGLE, [], (piece.faces + 1).ravel())
        gmsh.model.geo.addSurfaceLoop([number], number)
    for number, space in enumerate(spaces, 1):
        gmsh.model.geo.addVolume([piece + 1 for piece in (space.around, *space.inside)], number)
    gmsh.model.geo.synchronize()


def _limit_edges(gmsh: ModuleType, spaces: Sequence[Space], largest_mm3: Mapping[int, float]) -> None:
    limited = [(number, largest_mm3[space.region]) for number, space in enumerate(spaces, 1) if space.region in largest_mm3]
    if not limited:
        return
    fields = []
    for volume, mm3 in limited:
        fields.append(gmsh.model.mesh.field.add("Constant"))
        gmsh.model.mesh.field.setNumbers(fields[-1], "VolumesList", [volume])
        gmsh.model.mesh.field.setNumber(fields[-1], "VIn", SIZE * float(np.cbrt(6.0 * np.sqrt(2.0) * mm3)))
    smallest = gmsh.model.mesh.field.add("Min")
    gmsh.model.mesh.field.setNumbers(smallest, "FieldsList", fields)
    gmsh.model.mesh.field.setAsBackgroundMesh(smallest)


def _result(gmsh: ModuleType, spaces: Sequence[Space]) -> Filling:
    """Nodes in the order of their numbers, so those of the surfaces come first."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags, kind="stable")
    place = np.empty(int(tags.max()) + 1, dtype=np.int32)
    place[tags[order].astype(np.int64)] = np.arange(len(tags), dtype=np.int32)
    parts = [gmsh.model.mesh.getElementsByType(TETRAHEDRON, number)[1].reshape(-1, 4) for number in range(1, len(spaces) + 1)]
    region = np.repeat([space.region for space in spaces], [len(part) for part in parts]).astype(np.int32)
    return Filling(coordinates.reshape(-1, 3)[order], place[np.vstack(parts).astype(np.int64)], region)
