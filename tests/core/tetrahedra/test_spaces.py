"""What is inside what, counted on balls."""

from __future__ import annotations

import numpy as np

from core.tetrahedra.spaces import Space, find_pieces, find_spaces
from tests.solids import flipped, sphere, together


def spaces_of(surfaces, nesting):
    vertices = np.vstack([mesh.vertices for mesh in surfaces.values()])
    return find_spaces(vertices, find_pieces(surfaces), surfaces, nesting)


def test_a_space_reaches_to_the_next_surfaces_inside_and_no_farther():
    surfaces = {"core": sphere(3.0, 1), "outer": sphere(10.0, 1), "inner": sphere(8.0, 1)}
    assert spaces_of(surfaces, {"core": "inner", "outer": None, "inner": "outer"}) == (
        Space(0, 0, ()),
        Space(1, 1, (2,)),
        Space(2, 2, (0,)),
    )


def test_pieces_of_one_surface_are_spaces_of_their_own():
    pair = together(sphere(2.0, 1, at=(-4.0, 0.0, 0.0)), sphere(1.0, 1, at=(4.0, 0.0, 0.0)))
    surfaces = {"outer": sphere(10.0, 1), "pair": pair}
    assert spaces_of(surfaces, {"outer": None, "pair": "outer"}) == (Space(0, 0, (1, 2)), Space(1, 1, ()), Space(1, 2, ()))


def test_a_cavity_is_filled_by_the_tissue_around_and_that_of_the_outermost_by_nothing():
    hollow = together(sphere(4.0, 1), flipped(sphere(2.0, 1)))
    assert spaces_of({"outer": sphere(10.0, 1), "hollow": hollow}, {"outer": None, "hollow": "outer"}) == (
        Space(0, 0, (1,)),
        Space(1, 1, (2,)),
        Space(0, 2, ()),
    )
    assert spaces_of({"hollow": hollow}, {"hollow": None}) == (Space(0, 0, (1,)),)


def test_equal_balls_side_by_side_hold_nothing():
    surfaces = {"left": sphere(1.0, 1, at=(-2.0, 0.0, 0.0)), "right": sphere(1.0, 1, at=(2.0, 0.0, 0.0))}
    assert spaces_of(surfaces, {"left": None, "right": None}) == (Space(0, 0, ()), Space(1, 1, ()))
