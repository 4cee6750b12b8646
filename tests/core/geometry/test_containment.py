import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.geometry import containment
from core.geometry.containment import find_crossings, is_inside
from core.geometry.distance import closest_points
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from tests.solids import cube, flipped, octahedron, sphere, tetrahedron, together, torus


def tree_of(mesh: Mesh) -> FaceTree:
    return FaceTree.of(mesh.vertices, mesh.faces)


@pytest.mark.parametrize(
    ("mesh", "holds"),
    [
        (cube(2.0, at=(-1, -1, -1)), lambda p: np.abs(p).max(axis=1) < 1),
        (octahedron(2.0), lambda p: np.abs(p).sum(axis=1) < 2),
        (tetrahedron(4.0, at=(-1, -1, -1)), lambda p: (p > -1).all(axis=1) & ((p + 1).sum(axis=1) < 4)),
    ],
    ids=["cube", "octahedron", "tetrahedron"],
)
def test_lattice_points_whose_rays_run_through_corners_and_edges(mesh, holds):
    grid = np.arange(-3.0, 3.5, 0.5)
    points = np.array(np.meshgrid(grid, grid, grid)).reshape(3, -1).T
    off = closest_points(mesh.vertices, mesh.faces, points)[0] > 1e-9
    assert 0 < holds(points).sum() < off.sum() < len(points)
    assert (is_inside(tree_of(mesh), points)[off] == holds(points)[off]).all()


@given(st.lists(st.floats(-4.5, 4.5), min_size=3, max_size=3))
def test_torus(point):
    mesh = torus(3.0, 1.0, 48, 32)
    x, y, z = point
    to_ring = np.hypot(np.hypot(x, y) - 3.0, z)
    if abs(to_ring - 1.0) > 0.03:  # the faces cut corners by less than this
        assert is_inside(tree_of(mesh), np.array([point])).tolist() == [to_ring < 1.0]


def test_cavities_are_outside_and_orientation_plays_no_part():
    hollow = together(sphere(3.0), flipped(sphere(2.0)), sphere(1.0))
    points = np.array([[0, 0, 0], [1.5, 0, 0], [2.5, 0, 0], [4, 0, 0], [-1.5, 0, 0]])
    for mesh in (hollow, flipped(hollow), flipped(hollow, [3, 40])):
        assert is_inside(tree_of(mesh), points).tolist() == [True, False, True, False, False]


def test_crossed_faces_are_named():
    points = np.array([[-1.0, 0.4, 0.5], [0.5, 0.4, 0.5], [0.0, 0.4, 0.5], [1.0, 0.4, 0.5]])
    point, face = find_crossings(tree_of(cube()), points)
    at = cube().triangles()[face].mean(axis=1)[:, 0]
    assert sorted(zip(point.tolist(), at.tolist(), strict=True)) == [(0, 0.0), (0, 1.0), (1, 1.0), (2, 1.0)]


def test_many_points_are_asked_in_portions(monkeypatch):
    points = np.random.default_rng(3).uniform(-2, 2, (50, 3))
    at_once = [numbers.tolist() for numbers in find_crossings(tree_of(sphere()), points)]
    monkeypatch.setattr(containment, "POINTS_AT_ONCE", 7)
    assert [numbers.tolist() for numbers in find_crossings(tree_of(sphere()), points)] == at_once
    assert is_inside(tree_of(sphere()), np.empty((0, 3))).tolist() == []
