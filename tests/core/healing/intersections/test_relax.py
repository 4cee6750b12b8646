"""Patches of planes and balls: what comes out is known."""

from __future__ import annotations

import numpy as np
import pytest

from core.healing.intersections.relax import relax
from subjects.damage.places import near
from subjects.generated.pieces import together
from subjects.generated.revolved import ball
from subjects.generated.solid import block


@pytest.mark.parametrize("order", [1, 2])
def test_dented_plane_becomes_flat(order: int) -> None:
    cube = block(40, 40, 40, 2.5)
    free = near(cube, np.array([0, 0, 20.0]), 10.0)
    dented = cube.vertices.copy()
    dented[free] += np.random.default_rng(3).normal(scale=3.0, size=(int(free.sum()), 3))
    flat = relax(dented, cube.faces, free, order)
    assert np.array_equal(flat[~free], cube.vertices[~free])
    assert np.abs(flat[free, 2] - 20.0).max() < 1e-5


def test_second_order_continues_a_ball() -> None:
    sphere = ball(30, 4)
    free = near(sphere, np.array([0, 0, 30.0]), 10.0)
    off = [np.abs(np.linalg.norm(relax(sphere.vertices, sphere.faces, free, order), axis=1) - 30).max() for order in (1, 2)]
    assert off[0] > 0.5  # a skin over the rim is flat
    assert off[1] < 0.1


@pytest.mark.parametrize("order", [1, 2])
def test_piece_without_hold_stays(order: int) -> None:
    both = together(ball(30, 3), ball(5, 1))
    free = np.arange(len(both.vertices)) >= len(ball(30, 3).vertices)
    free[:10] = True
    moved = relax(both.vertices, both.faces, free, order)
    assert np.array_equal(moved[-42:], both.vertices[-42:])
    assert not np.array_equal(moved[:10], both.vertices[:10])
