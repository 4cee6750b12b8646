"""The benchmark's referee tells good shells from bad ones, by their files alone."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.makers import MAKERS, integument, level_set_offset, vertex_normal_offset
from benchmarks.referee import Judgement, judge
from core.io.registry import write_mesh
from core.mesh import Mesh
from subjects.generated.revolved import ball
from subjects.generated.solid import comb


def judged(folder: Path, skin: Mesh, shells: list[Mesh], depths_mm: tuple[float, ...]) -> Judgement:
    names = ["skin", *(f"{row}" for row in range(len(shells)))]
    files = [folder / f"{name}.stl" for name in names]
    for name, file, mesh in zip(names, files, [skin, *shells], strict=True):
        write_mesh(mesh, file, "stl", name)
    return judge(files[0], files[1:], depths_mm)


def test_our_shells_of_a_ball_are_right(tmp_path: Path) -> None:
    skin = ball(30, 3)
    found = judged(tmp_path, skin, integument(skin, (1.0, 3.0)), (1.0, 3.0))
    assert (found.crossing_pairs, found.closed, found.vertices_outside) == (0, True, 0)
    assert found.on_target == (1.0, 1.0)
    assert found.missed_with_room == (0.0, 0.0)
    assert found.min_gap_mm == pytest.approx(1.0, abs=0.02)
    assert found.tetrahedra is not None
    assert found.tetrahedra > len(skin.faces)


def test_naive_shells_of_a_comb_cross(tmp_path: Path) -> None:
    skin = comb(3, 4, 0.5, 2.0)
    found = judged(tmp_path, skin, vertex_normal_offset(skin, (1.0, 3.0)), (1.0, 3.0))
    assert found.crossing_pairs > 0
    assert found.min_gap_mm == 0.0
    assert found.tetrahedra is None


def test_vertices_outside_the_skin_are_counted(tmp_path: Path) -> None:
    shell = ball(31, 2)
    assert judged(tmp_path, ball(30, 3), [shell], (1.0,)).vertices_outside == len(shell.vertices)


def test_depth_missed_where_there_is_room_is_seen(tmp_path: Path) -> None:
    found = judged(tmp_path, ball(30, 3), [ball(28, 3)], (1.0,))
    assert found.on_target == (0.0,)
    assert found.missed_with_room == (1.0,)


def test_level_set_of_a_ball_is_a_smaller_ball() -> None:
    (shell,) = level_set_offset(ball(30, 4), (3.0,))
    assert np.linalg.norm(shell.vertices, axis=1) == pytest.approx(27.0, abs=0.2)


def test_peers_are_there() -> None:
    assert len(MAKERS) >= 4
