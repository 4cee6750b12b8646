"""Longest edges halved: the same surface, closed, with the angles it had."""

import numpy as np
import pytest

from core.geometry.adjacency import edges
from core.geometry.bisection import halve_longest_edges, longest_edges
from core.geometry.volume import signed_volumes
from tests.solids import cube, sphere


def volume(vertices, faces) -> float:
    return float(signed_volumes(vertices, faces, np.zeros(len(faces), dtype=np.int64))[0])


def test_a_cube_stays_a_cube_however_often_one_corner_is_refined() -> None:
    vertices, faces = cube(8.0).vertices, cube(8.0).faces
    for _ in range(6):
        wanted = (vertices[faces] == 0.0).all(axis=2).any(axis=1)  # faces at the origin
        vertices, faces = halve_longest_edges(vertices, faces, wanted)
        assert (edges(faces).face_count == 2).all()
        assert volume(vertices, faces) == pytest.approx(512.0)
    assert np.array_equal(vertices[:8], cube(8.0).vertices)
    at_origin = (vertices[faces] == 0.0).all(axis=2).any(axis=1)
    assert longest_edges(vertices, faces)[at_origin].max() < 0.3 * longest_edges(vertices, faces).max()


def test_nothing_wanted_is_nothing_changed() -> None:
    ball = sphere(5.0, 2)
    vertices, faces = halve_longest_edges(ball.vertices, ball.faces, np.zeros(len(ball.faces), dtype=bool))
    assert np.array_equal(vertices, ball.vertices)
    assert np.array_equal(faces, ball.faces)
