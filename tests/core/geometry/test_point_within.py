"""A point per piece and per cavity, on the right side of the surface."""

from __future__ import annotations

import numpy as np

from core.geometry.containment import is_inside
from core.geometry.face_tree import FaceTree
from core.geometry.point_within import find_points_within
from tests.solids import flipped, sphere, together


def test_a_thin_shell_with_a_cavity_has_a_point_in_its_wall_and_one_in_the_cavity():
    mesh = together(sphere(10.0, 3), flipped(sphere(9.9, 3)))
    within, cavities = find_points_within(mesh, 0.04)
    assert len(within) == len(cavities) == 1
    assert is_inside(FaceTree.of(mesh.vertices, mesh.faces), within)[0]
    assert np.linalg.norm(cavities[0]) < 9.9


def test_every_piece_has_its_own():
    mesh = together(sphere(1.0, 2), sphere(1.0, 2, at=(5.0, 0.0, 0.0)), sphere(0.2, 2, at=(0.0, 5.0, 0.0)))
    within, cavities = find_points_within(mesh, 0.04)
    centres = np.array([(0.0, 0.0, 0.0), (5.0, 0.0, 0.0), (0.0, 5.0, 0.0)])
    assert len(cavities) == 0
    assert sorted(np.linalg.norm(within[:, None] - centres, axis=2).argmin(axis=1).tolist()) == [0, 1, 2]


def test_a_piece_thinner_than_that_has_none():
    flat = sphere(10.0, 2)
    within, _ = find_points_within(flat.with_vertices(flat.vertices * (1.0, 1.0, 1e-4)), 0.04)
    assert len(within) == 0
