import numpy as np
import pytest

from core.geometry.adjacency import edges
from core.geometry.dihedral import dihedral_angles
from tests.solids import cube, flipped, octahedron


def angles(mesh):
    return dihedral_angles(mesh.vertices, mesh.faces, edges(mesh.faces))


def test_a_cube_has_twelve_right_angles_and_six_flat_diagonals():
    degrees = angles(cube())[2]
    assert sorted(degrees) == pytest.approx([90.0] * 12 + [180.0] * 6)


def test_an_octahedron():
    assert angles(octahedron())[2] == pytest.approx(np.degrees(np.arccos(-1 / 3)))


def test_orientation_plays_no_part():
    assert angles(flipped(cube(), [0, 3, 4]))[2] == pytest.approx(angles(cube())[2])
    assert angles(flipped(octahedron()))[2] == pytest.approx(angles(octahedron())[2])


@pytest.mark.parametrize("degrees", [0.0, 0.001, 30.0, 90.0, 179.0, 180.0])
def test_a_hinge_opens_as_far_as_it_was_opened(degrees):
    tip = [np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.5]
    vertices = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0.3], tip])
    faces = np.array([[0, 1, 2], [1, 0, 3]], dtype=np.int32)
    edge, pair, found = dihedral_angles(vertices, faces, edges(faces))
    assert edge.tolist() == [0]
    assert pair.tolist() == [[0, 1]]
    assert found == pytest.approx([degrees], abs=1e-9)


def test_faces_without_area_have_no_angle():
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]], dtype=float)
    faces = np.array([[0, 1, 2], [1, 0, 3]], dtype=np.int32)
    assert len(dihedral_angles(vertices, faces, edges(faces))[0]) == 0
