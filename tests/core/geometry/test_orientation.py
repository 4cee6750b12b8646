import numpy as np

from core.geometry.adjacency import edges
from core.geometry.orientation import find_faces_to_flip, find_inconsistent_edges
from tests.solids import cube, flipped, moebius_strip, sphere, together


def test_a_sphere_agrees_with_itself():
    table = edges(sphere().faces)
    assert len(find_inconsistent_edges(table)[0]) == 0
    assert find_faces_to_flip(table).tolist() == []


def test_one_turned_face_disagrees_at_three_edges():
    mesh = flipped(cube(), [5])
    edge, faces = find_inconsistent_edges(edges(mesh.faces))
    assert len(edge) == 3
    assert (faces == 5).any(axis=1).all()
    assert find_faces_to_flip(edges(mesh.faces)).tolist() == [5]


def test_the_minority_of_each_piece_is_to_be_flipped():
    first, second = flipped(cube(), np.arange(2, 12)), flipped(sphere(at=(9, 0, 0)), [7])
    assert find_faces_to_flip(edges(together(first, second).faces)).tolist() == [0, 1, 12 + 7]


def test_two_faces_that_disagree_keep_the_first():
    assert find_faces_to_flip(edges(np.array([[0, 1, 2], [0, 1, 3]], dtype=np.int32))).tolist() == [1]


def test_a_moebius_strip_cannot_be_oriented():
    table = edges(moebius_strip().faces)
    assert len(find_inconsistent_edges(table)[0]) == 1
    assert find_faces_to_flip(table) is None
