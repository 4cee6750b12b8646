import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from core.geometry.coincidence import find_equal_face_pairs, group_equal_faces, position_ids


def test_position_ids_name_the_lowest_vertex_at_each_place():
    vertices = np.array([[1.0, 2, 3], [0, 0, 0], [1, 2, 3], [-0.0, 0, 0], [1, 2, 3.0000001]])
    assert position_ids(vertices).tolist() == [0, 1, 0, 1, 4]


@given(st.lists(st.tuples(*[st.integers(-1, 1)] * 3), min_size=1, max_size=30))
def test_position_ids_agree_with_a_dictionary(places):
    first: dict[tuple[int, ...], int] = {}
    expected = [first.setdefault(place, number) for number, place in enumerate(places)]
    assert position_ids(np.array(places, dtype=float)).tolist() == expected


def test_equal_faces_are_found_in_any_order_and_direction():
    faces = np.array([[0, 1, 2], [3, 4, 5], [2, 1, 0], [1, 2, 0], [3, 4, 6]])
    assert group_equal_faces(faces).tolist() == [0, 1, 0, 0, 4]
    assert find_equal_face_pairs(faces).tolist() == [[0, 2], [0, 3], [2, 3]]


def test_faces_that_repeat_a_corner_are_not_doubled():
    assert find_equal_face_pairs(np.array([[0, 1, 1], [0, 1, 1]])).tolist() == []
