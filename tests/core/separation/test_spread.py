"""Displacements fade with the distance along the surface."""

import numpy as np

from core.geometry.connectivity import Connectivity
from core.separation.spread import SLOPE, least_lengths, spread
from tests.solids import sphere

BALL = sphere(10.0, 3)
NEIGHBOURS = Connectivity.of(BALL.faces, len(BALL.vertices)).neighbours


def test_a_deep_move_draws_its_surroundings_along_and_no_step_is_left() -> None:
    wish = np.zeros_like(BALL.vertices)
    wish[0] = [2.0, 0.0, 0.0]
    got = spread(BALL.vertices, NEIGHBOURS, wish)
    length = np.linalg.norm(got, axis=1)
    assert np.array_equal(got[0], wish[0])
    assert 10 < (length > 0.0).sum() < len(length)
    assert (got[:, 1:] == 0.0).all()  # along the move that draws
    missing = least_lengths(BALL.vertices, NEIGHBOURS, length) - length
    assert missing.max() < 1e-5
    # straight away from the vertex the move fades as a cone
    far = np.linalg.norm(BALL.vertices - BALL.vertices[0], axis=1)
    assert (length[far * SLOPE > 2.0] == 0.0).all()


def test_a_small_move_draws_nobody() -> None:
    wish = np.zeros_like(BALL.vertices)
    wish[5] = [0.0, 0.1, 0.0]
    assert np.array_equal(spread(BALL.vertices, NEIGHBOURS, wish), wish)


def test_nothing_long_enough_is_changed() -> None:
    wish = np.tile([0.0, 0.0, 3.0], (len(BALL.vertices), 1))
    assert np.array_equal(spread(BALL.vertices, NEIGHBOURS, wish), wish)
