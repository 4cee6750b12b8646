"""Unions of cubes and balls: volumes, what stays bit for bit, and good seams."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.deviation import measure_deviation
from core.geometry.quality import quality
from core.geometry.volume import signed_volumes
from core.healing.intersections.arrangement import Arrangement
from core.healing.intersections.seam import tidy_seam
from core.healing.intersections.unite import unite
from core.mesh import Mesh
from subjects.generated.pieces import moved, together
from subjects.generated.revolved import ball
from subjects.generated.solid import block

APART = moved(ball(15, 3), 17.3, 3.1, 1.7)


def united(mesh: Mesh) -> tuple[Mesh, np.ndarray, np.ndarray]:
    vertices, faces, is_new, birth = unite(mesh.vertices, mesh.faces, Arrangement.of(mesh.vertices, mesh.faces))
    return Mesh.of(vertices, faces), is_new, birth


def test_volume_of_cubes() -> None:
    mesh, _, _ = united(together(block(2, 2, 2), moved(block(2, 2, 2), 1, 1, 1)))
    assert signed_volumes(mesh.vertices, mesh.faces, np.zeros(len(mesh.faces), dtype=np.int64)) == pytest.approx([15])


def test_faces_that_nothing_cuts_stay() -> None:
    both = together(ball(15, 3), APART)
    mesh, is_new, birth = united(both)
    kept = int((~is_new).sum())
    assert kept > 1900
    assert not is_new[:kept].any()
    assert np.array_equal(mesh.faces[:kept], both.faces[birth[:kept]])
    assert np.array_equal(mesh.vertices[: len(both.vertices)], both.vertices)
    assert np.array_equal(mesh.vertices, mesh.vertices.astype(np.float32))


def test_swallowed_piece_is_gone() -> None:
    mesh, is_new, birth = united(together(ball(15, 3), ball(5, 2)))
    assert not is_new.any()
    assert np.array_equal(birth, np.arange(1280))
    assert np.array_equal(mesh.faces, ball(15, 3).faces)


def test_equal_input_gives_equal_bytes() -> None:
    first, second = (united(together(ball(15, 3), APART))[0] for _ in range(2))
    assert first.vertices.tobytes() == second.vertices.tobytes()
    assert first.faces.tobytes() == second.faces.tobytes()


def test_seam_without_slivers() -> None:
    mesh, is_new, birth = united(together(ball(15, 3), APART))
    vertices, faces = tidy_seam(mesh.vertices, mesh.faces, is_new, birth // 1280)
    kept = int((~is_new).sum())
    assert np.array_equal(faces[:kept], mesh.faces[:kept])
    assert quality(mesh.vertices, mesh.faces).min() < 0.001
    assert quality(vertices, faces).min() > 0.005
    assert measure_deviation(mesh, Mesh.of(vertices, faces)).maximum_mm < 0.02
