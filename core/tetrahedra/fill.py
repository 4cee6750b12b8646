"""Fill nested surfaces with tetrahedra by TetGen or gmsh, and prove that they did."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, IntegumentError
from core.geometry.point_within import find_points_within
from core.mesh import Mesh
from core.tetrahedra.forked import Filling
from core.tetrahedra.gmsh import run_gmsh
from core.tetrahedra.prove_filled import prove_filled
from core.tetrahedra.regions import spread_regions
from core.tetrahedra.spaces import find_pieces, find_spaces
from core.tetrahedra.tetgen import Facets
from core.tetrahedra.tetgen_ways import fill_facets
from core.tetrahedra.volume_mesh import Mesher, VolumeMesh

AskedMesher = Literal["auto", Mesher]
GIVEN_UP = ("tetrahedra.refused", "tetrahedra.not_proven")
FIRST_REGION = 1  # TetGen takes 0 for none


def fill(
    surfaces: Mapping[str, Mesh],
    nesting: Mapping[str, str | None],
    *,
    gap_mm: float,
    mesher: AskedMesher = "auto",
    radius_edge: float | None = None,
    largest_mm3: Mapping[str, float] | None = None,
) -> VolumeMesh:
    """Tetrahedra in all tissues, no vertex added on a surface.

    Needs:    surfaces closed, outward, free of intersections, `gap_mm` apart; nesting: name -> the surface around it.
              mesher: `auto` is TetGen, and gmsh where TetGen gives up.
              radius_edge: for TetGen, largest ratio of circumradius to shortest edge, where the surfaces allow it; None: as they
              fall. largest_mm3: name -> largest tetrahedron of that tissue, likewise.
    Promises: every face of every surface is a face of tetrahedra; all are right-handed; the volumes of each tissue add up to that
              between its surface and those inside. A cavity of a tissue belongs to the tissue around it, of the outermost to
              nobody. `region` counts the surfaces from 0, in their order.
    Raises:   InputError `tetrahedra.no_room`, `tetrahedra.refused` with what the mesher said; LimitError `limit.memory`,
              `tetrahedra.too_many_vertices`; StateError `tetrahedra.no_mesher`; InternalError `tetrahedra.not_proven`.
    Source:   Si 2015, doi:10.1145/2629697; Geuzaine and Remacle 2009, doi:10.1002/nme.2579.
    """
    vertices = np.vstack([mesh.vertices for mesh in surfaces.values()])
    limits = largest_mm3 or {}
    if mesher == "gmsh":
        return _by_gmsh(vertices, surfaces, nesting, limits)
    try:
        return _by_tetgen(vertices, surfaces, nesting, gap_mm, radius_edge, limits)
    except IntegumentError as refusal:
        if refusal.code not in GIVEN_UP:
            raise
        if mesher == "tetgen":
            raise _with(refusal, "`mesher` gmsh may fill them") from refusal
        try:
            return _by_gmsh(vertices, surfaces, nesting, limits)
        except IntegumentError as again:
            raise _with(refusal, f"Then gmsh was asked: {again.message}") from again


def _with(refusal: IntegumentError, more: str) -> IntegumentError:
    """The same refusal with more words."""
    told = type(refusal)(refusal.code, f"{refusal.message} {more}")
    told.facts = refusal.facts
    return told


def _proven(made: Filling, mesher: Mesher, surfaces: Mapping[str, Mesh], nesting: Mapping[str, str | None]) -> VolumeMesh:
    """The tetrahedra in tissues; what is left is the air in cavities of the outermost."""
    known = (made.region >= 0) & (made.region < len(surfaces))
    volume = VolumeMesh(made.nodes, np.ascontiguousarray(made.tetrahedra[known], dtype=np.int32), made.region[known], mesher)
    prove_filled(volume, surfaces, nesting)
    return volume


def _by_gmsh(
    vertices: NDArray[np.float64],
    surfaces: Mapping[str, Mesh],
    nesting: Mapping[str, str | None],
    limits: Mapping[str, float],
) -> VolumeMesh:
    pieces = find_pieces(surfaces)
    largest = {number: limits[name] for number, name in enumerate(surfaces) if name in limits}
    made = run_gmsh(vertices, pieces, find_spaces(vertices, pieces, surfaces, nesting), largest)
    return _proven(made, "gmsh", surfaces, nesting)


def _by_tetgen(
    vertices: NDArray[np.float64],
    surfaces: Mapping[str, Mesh],
    nesting: Mapping[str, str | None],
    gap_mm: float,
    radius_edge: float | None,
    limits: Mapping[str, float],
) -> VolumeMesh:
    names = list(surfaces)
    points, region = _region_points(surfaces, nesting, gap_mm)
    largest = np.array([limits.get(names[number], 0.0) for number in region])
    first_vertex = np.cumsum([0, *(len(mesh.vertices) for mesh in surfaces.values())])
    faces = np.vstack([mesh.faces + np.int32(start) for mesh, start in zip(surfaces.values(), first_vertex, strict=False)])
    switches = f"pYY{'' if radius_edge is None else f'q{radius_edge:g}'}{'a' if limits else ''}AQ"

    def finish(made: Filling) -> VolumeMesh:
        number = spread_regions(made.nodes, made.tetrahedra, made.region, faces) - np.int32(FIRST_REGION)
        return _proven(Filling(made.nodes, made.tetrahedra, number), "tetgen", surfaces, nesting)

    return fill_facets(Facets(vertices, faces, points, region + FIRST_REGION, largest), switches, finish)


def _region_points(
    surfaces: Mapping[str, Mesh], nesting: Mapping[str, str | None], gap_mm: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """A point for every closed space (N, 3) and the number of the surface whose tissue fills it (N,)."""
    names = list(surfaces)
    points: list[NDArray[np.float64]] = []
    region: list[int] = []
    for number, (name, mesh) in enumerate(surfaces.items()):
        within, cavities = find_points_within(mesh, gap_mm)
        if not len(within):
            raise InputError("tetrahedra.no_room", f"no point was found inside '{name}': it is thinner than {gap_mm / 4:g} mm")
        around = nesting[name]
        points += [within] if around is None else [within, cavities]
        region += [number] * len(within) + ([] if around is None else [names.index(around)] * len(cavities))
    return np.vstack(points), np.array(region, dtype=np.int64)
