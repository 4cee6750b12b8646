"""Fill nested surfaces with tetrahedra by TetGen, and prove that it did."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.point_within import find_points_within
from core.mesh import Mesh
from core.tetrahedra.prove_filled import prove_filled
from core.tetrahedra.volume_mesh import VolumeMesh

SAID_BYTES = 2000
FIRST_REGION = 1  # TetGen takes 0 for none


def fill(
    surfaces: Mapping[str, Mesh],
    nesting: Mapping[str, str | None],
    *,
    gap_mm: float,
    radius_edge: float | None = None,
    largest_mm3: Mapping[str, float] | None = None,
) -> VolumeMesh:
    """Tetrahedra in all tissues, no vertex added on a surface.

    Needs:    surfaces closed, outward, free of intersections, `gap_mm` apart; nesting: name -> the surface around it.
              radius_edge: largest ratio of circumradius to shortest edge, where the surfaces allow it; None: as they fall.
              largest_mm3: name -> largest tetrahedron of that tissue, likewise.
    Promises: every face of every surface is a face of tetrahedra; all are right-handed; the volumes of each tissue add up to that
              between its surface and those inside. A cavity of a tissue belongs to the tissue around it, of the outermost to
              nobody. `region` counts the surfaces from 0, in their order.
    Raises:   InputError `tetrahedra.no_room`, `tetrahedra.refused` with what TetGen said; InternalError `tetrahedra.not_proven`.
    Source:   Si 2015, doi:10.1145/2629697.
    """
    names = list(surfaces)
    points, region = _region_points(surfaces, nesting, gap_mm)
    limits = largest_mm3 or {}
    largest = np.array([limits.get(names[number], 0.0) for number in region])
    first_vertex = np.cumsum([0, *(len(mesh.vertices) for mesh in surfaces.values())])
    vertices = np.vstack([mesh.vertices for mesh in surfaces.values()])
    faces = np.vstack([mesh.faces + np.int32(start) for mesh, start in zip(surfaces.values(), first_vertex, strict=False)])
    switches = f"pY{'' if radius_edge is None else f'q{radius_edge:g}'}{'a' if limits else ''}AQ"
    with TemporaryDirectory(prefix="tetgen-") as folder:
        given, made = Path(folder) / "given.npz", Path(folder) / "made.npz"
        np.savez(given, vertices=vertices, faces=faces, points=points, region=region + FIRST_REGION, largest=largest)
        _run_tetgen([str(given), str(made), switches])
        with np.load(made, allow_pickle=False) as result:
            numbers = np.rint(result["region"]).astype(np.int32) - FIRST_REGION
            known = (numbers >= 0) & (numbers < len(names))  # what is left is the air in cavities of the outermost
            volume = VolumeMesh(
                np.ascontiguousarray(result["nodes"], dtype=np.float64),
                np.ascontiguousarray(result["tetrahedra"][known], dtype=np.int32),
                numbers[known],
            )
    prove_filled(volume, surfaces, nesting)
    return volume


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


def _run_tetgen(words: Sequence[str]) -> None:
    command = [sys.executable, "-m", "core.tetrahedra.tetgen_program", *words]
    done = subprocess.run(command, capture_output=True, stdin=subprocess.DEVNULL, check=False)  # noqa: S603 - our own program
    if done.returncode:
        said = done.stderr[-SAID_BYTES:].decode(errors="replace").strip() or "nothing"
        ended = f"by signal {-done.returncode}" if done.returncode < 0 else f"with code {done.returncode}"
        raise InputError("tetrahedra.refused", f"TetGen ended {ended} and said: {said}", exit_code=done.returncode)
