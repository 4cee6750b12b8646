import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.geometry.disc_bounds import between_discs, disc_bounds
from core.geometry.distance import smallest_gap_between
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from tests.solids import cube, sphere, together, torus


def tree_of(mesh: Mesh) -> FaceTree:
    return FaceTree.of(mesh.vertices, mesh.faces)


def soup(seed: int, faces: int) -> Mesh:
    """Random triangles, every fifth one a line."""
    corners = np.random.default_rng(seed).normal(size=(faces, 3, 3))
    corners[::5, 2] = corners[::5, 1]
    return Mesh.of(corners.reshape(-1, 3), np.arange(3 * faces).reshape(-1, 3))


def held_by(tree: FaceTree, node: int) -> np.ndarray:
    """Corners of all faces below a node, (K, 3)."""
    first = last = node
    while first < tree.leaves - 1:
        first, last = 2 * first + 1, 2 * last + 2
    first, last = first - tree.leaves + 1, last - tree.leaves + 1
    count = len(tree.corners)
    return tree.corners[first * count // tree.leaves : (last + 1) * count // tree.leaves].reshape(-1, 3)


@pytest.mark.parametrize("mesh", [cube(), sphere(5.0, 3), torus(), soup(1, 40), together(sphere(), cube(at=(500, 0, 0)))])
def test_every_disc_holds_its_faces(mesh):
    tree = tree_of(mesh)
    discs = disc_bounds(tree)
    for node, (x, y, z, *axis, radius, half) in enumerate(discs):
        assert np.linalg.norm(axis) == pytest.approx(1.0)
        offset = held_by(tree, node) - [x, y, z]
        height = offset @ axis
        assert np.abs(height).max() <= half
        assert np.linalg.norm(offset - height[:, None] * axis, axis=1).max() <= radius


@given(st.integers(0, 50), st.integers(1, 12), st.integers(1, 12), st.sampled_from([0.0, 2.0, 8.0]))
def test_bounds_are_never_above_the_distance(seed, faces_a, faces_b, apart):
    a, b = tree_of(soup(seed, faces_a)), soup(seed + 100, faces_b)
    moved = b.vertices + np.array([apart, 0.0, 0.0])
    b = tree_of(b.with_vertices(moved))
    gap = smallest_gap_between(a, b).distance_mm
    discs_a, discs_b = disc_bounds(a), disc_bounds(b)
    assert between_discs(discs_a, 0, discs_b, 0) <= gap**2
    for node_a in range(len(discs_a)):
        for node_b in range(len(discs_b)):
            nearest = np.linalg.norm(held_by(a, node_a)[:, None] - held_by(b, node_b)[None], axis=2).min()
            assert between_discs(discs_a, node_a, discs_b, node_b) <= nearest**2


def test_discs_of_a_sphere_are_flat():
    tree = tree_of(sphere(100.0, 5))
    discs = disc_bounds(tree)
    # a patch of radius r on a sphere of radius R is r²/R high; its box would be as high as wide
    lowest = discs[tree.leaves // 8 - 1 : tree.leaves // 4 - 1]
    assert (lowest[:, 7] < 0.2 * lowest[:, 6]).all()
