import numpy as np
import pytest

from core.geometry.adjacency import edges
from core.geometry.components import face_components, find_split_vertices, label_connected
from core.mesh import Mesh
from tests.solids import cube, moebius_strip, sphere, tetrahedron, together, torus

BOW_TIE = np.array([[0, 1, 2], [0, 3, 4]], dtype=np.int32)
BOOK = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]], dtype=np.int32)


def test_labels_follow_the_lowest_node():
    assert label_connected(5, np.array([3, 1]), np.array([1, 4]))[1].tolist() == [0, 1, 2, 1, 1]


def test_pieces():
    mesh = together(sphere(), cube(at=(5, 0, 0)), tetrahedron(at=(9, 0, 0)))
    count, label = face_components(edges(mesh.faces))
    assert count == 3
    assert label.tolist() == [0] * 128 + [1] * 12 + [2] * 4


def test_faces_that_share_only_a_corner_are_two_pieces():
    assert face_components(edges(BOW_TIE))[0] == 2
    assert face_components(edges(BOOK))[0] == 1


@pytest.mark.parametrize(
    "mesh", [sphere(), torus(), cube(), tetrahedron(), moebius_strip()], ids=lambda mesh: str(len(mesh.faces))
)
def test_surfaces_have_one_fan_at_every_vertex(mesh):
    assert find_split_vertices(mesh.faces, edges(mesh.faces)).tolist() == []


def test_the_waist_of_a_bow_tie_is_split():
    assert find_split_vertices(BOW_TIE, edges(BOW_TIE)).tolist() == [0]
    assert find_split_vertices(BOOK, edges(BOOK)).tolist() == []


def test_two_tetrahedra_tip_to_tip():
    both = together(tetrahedron(), tetrahedron(-1.0))
    faces = np.where(both.faces == 4, 0, both.faces)  # weld the two tips
    welded = Mesh.of(both.vertices, faces)
    assert find_split_vertices(welded.faces, edges(welded.faces)).tolist() == [0]


def test_split_is_found_whatever_the_orientation():
    turned = BOW_TIE.copy()
    turned[1] = turned[1][::-1]
    fan = np.array([[0, 1, 2], [0, 3, 2], [0, 3, 1]], dtype=np.int32)
    assert find_split_vertices(turned, edges(turned)).tolist() == [0]
    assert find_split_vertices(fan, edges(fan)).tolist() == []
