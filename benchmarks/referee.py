"""Judge shells by the files they were written to; the same for everybody."""

from __future__ import annotations

import subprocess
import sys
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import igl
import numpy as np

from core.geometry.distance import closest_points_in, smallest_gap
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.normals import face_areas, vertex_normals
from core.io.registry import read_meshes
from core.mesh import Mesh
from core.shells.reach import measure_reach
from core.shells.room import ON_TARGET
from core.validation.measure import measure_surface
from core.validation.surface import Surface

TETGEN_LIMIT_S = 300
ROOMY = 1.5  # times the depth: where the reach is at least this, a depth missed is the engine's fault


@dataclass(frozen=True, slots=True)
class Judgement:
    """exact_seconds: one exact call on all surfaces. on_target, missed_with_room: shares of area, one per layer."""

    exact_seconds: float
    crossing_pairs: int
    closed: bool
    vertices_outside: int
    min_gap_mm: float
    on_target: tuple[float, ...]
    missed_with_room: tuple[float, ...]
    min_quality: float
    quality_percentile_1: float
    min_dihedral_deg: float | None
    tetrahedra: int | None


def judge(skin_file: Path, shell_files: list[Path], depths_mm: tuple[float, ...]) -> Judgement:
    """Read back and measure; TetGen is asked only if nothing crosses and all is closed, or it would only say what is known."""
    skin, *shells = (read_meshes(path, file_name=path.name, unit="mm").meshes[0].mesh for path in (skin_file, *shell_files))
    vertices, faces = _concatenated([skin, *shells])
    start = time.perf_counter()
    crossing = find_intersecting_faces(vertices, faces)
    exact_seconds = time.perf_counter() - start

    reports = [measure_surface(Surface(path.stem, mesh)) for path, mesh in zip(shell_files, shells, strict=True)]
    tree = FaceTree.of(skin.vertices, skin.faces)
    shares = [_depth_shares(skin, tree, shell, depth) for shell, depth in zip(shells, depths_mm, strict=True)]
    closed = all(report.closed for report in reports)
    outside = sum(
        int((igl.fast_winding_number(skin.vertices, skin.faces.astype(np.int64), shell.vertices) < 0.5).sum()) for shell in shells
    )
    return Judgement(
        exact_seconds,
        len(crossing),
        closed,
        outside,
        min(smallest_gap(a, b)[0] for a, b in pairwise([skin, *shells])),
        tuple(on_target for on_target, _missed in shares),
        tuple(missed for _on_target, missed in shares),
        min(report.quality.minimum for report in reports),
        min(report.quality.percentile_1 for report in reports),
        min((report.minimum_dihedral_deg for report in reports if report.minimum_dihedral_deg is not None), default=None),
        _fill([skin_file, *shell_files]) if closed and len(crossing) == 0 else None,
    )


def _concatenated(meshes: list[Mesh]) -> tuple[np.ndarray, np.ndarray]:
    first = np.cumsum([0] + [len(mesh.vertices) for mesh in meshes])
    faces = np.concatenate([mesh.faces + start for mesh, start in zip(meshes, first, strict=False)])
    return np.concatenate([mesh.vertices for mesh in meshes]), faces


def _depth_shares(skin: Mesh, tree: FaceTree, shell: Mesh, depth_mm: float) -> tuple[float, float]:
    """Shares of the shell's area on target, and off target where the nearest skin has a reach of 1.5 depths or more."""
    distance, _foot, face = closest_points_in(tree, shell.vertices)
    areas = np.zeros(len(shell.vertices))
    np.add.at(areas, shell.faces.ravel(), np.repeat(face_areas(shell.vertices, shell.faces) / 3, 3))
    on_target = np.abs(distance - depth_mm) <= ON_TARGET * depth_mm
    normals = vertex_normals(skin.vertices, skin.faces, "area")
    reach = measure_reach(skin.vertices, skin.faces, normals, largest_mm=2 * ROOMY * depth_mm)
    roomy = reach[skin.faces[face]].min(axis=1) >= ROOMY * depth_mm
    total = areas.sum()
    return float(areas[on_target].sum() / total), float(areas[roomy & ~on_target].sum() / total)


def _fill(files: list[Path]) -> int | None:
    """Number of tetrahedra, None if TetGen refuses, crashes or takes too long."""
    command = [sys.executable, "-m", "benchmarks.fill_with_tetrahedra", *(str(path) for path in files)]
    try:
        outcome = subprocess.run(command, capture_output=True, text=True, timeout=TETGEN_LIMIT_S)
    except subprocess.TimeoutExpired:
        return None
    return int(outcome.stdout.split()[-1]) if outcome.returncode == 0 else None
