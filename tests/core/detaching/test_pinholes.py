"""Seams too small to be meant are counted, others not."""

import numpy as np

from core.detaching.pinholes import count_pinholes, count_tunnels
from core.geometry.cut_surface import CutSurface
from tests.solids import cube, sphere


def test_a_thin_canal_is_a_pinhole_and_a_wide_one_is_not() -> None:
    block = cube(10.0)
    drilled = CutSurface.uncut(block).without(sphere(1.0, 3, (5.0, 5.0, 10.0)), 0)
    assert drilled is not None
    assert count_pinholes(drilled, 1.0) == 0
    assert count_pinholes(drilled, 2.5) == 1
    assert count_tunnels(drilled, 0) == 0


def test_a_solid_through_both_sides_has_two_rings() -> None:
    block = cube(10.0)
    rod = sphere(1.0, 3).with_vertices(sphere(1.0, 3).vertices * (1.0, 1.0, 9.0) + np.array([5.0, 5.0, 5.0]))
    drilled = CutSurface.uncut(block).without(rod, 0)
    assert drilled is not None
    assert count_pinholes(drilled, 2.5) == 2
    assert count_tunnels(drilled, 0) == 1
    assert count_tunnels(drilled, 1) == 0  # no such wall
