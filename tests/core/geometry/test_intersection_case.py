import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from core.geometry.exact_intersection import find_intersecting_faces, find_intersecting_faces_between
from core.geometry.exact_predicates import are_collinear
from core.geometry.intersection_case import classify_intersections
from tests.solids import cube, tetrahedron

MASTER = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
SLAVES = {
    "sides of b cross the face of a": ([[1, 1, -1], [1, 1, 3], [1.5, 1, 3]], 1),
    "each has a side through the other": ([[1, 1, -1], [9, 1, -1], [1, 1, 3]], 2),
    "sides of a cross the face of b": ([[1, -20, -20], [1, -20, 30], [1, 40, 0]], 3),
    "apart": ([[1, 1, 1], [2, 1, 1], [1, 2, 1]], 0),
    "corner of b on the face of a": ([[1, 1, 0], [1, 1, 3], [2, 1, 3]], 1),
    "corner of b on a side of a": ([[1, 0, 0], [1, -1, 3], [2, -1, 3]], 2),
    "corner on corner": ([[0, 0, 0], [-1, 0, 3], [0, -1, 3]], 2),
    "flat, overlapping": ([[1, 1, 0], [9, 1, 0], [1, 9, 0]], 2),
    "flat, b within a": ([[1, 1, 0], [2, 1, 0], [1, 2, 0]], 1),
    "flat, a within b": ([[-9, -9, 0], [90, -9, 0], [-9, 90, 0]], 3),
    "flat, apart": ([[5, 5, 0], [9, 5, 0], [5, 9, 0]], 0),
    "flat, side along side": ([[1, 0, 0], [2, 0, 0], [1, -1, 0]], 2),
    "the same": (MASTER, 2),
}


@pytest.mark.parametrize("name", SLAVES)
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_two_faces(name, axis):
    slave, case = SLAVES[name]
    a, b = np.roll(np.array([MASTER], float), axis, axis=2), np.roll(np.array([slave], float), axis, axis=2)
    assert classify_intersections(a, b).tolist() == [case]
    assert classify_intersections(b, a).tolist() == [{1: 3, 3: 1}.get(case, case)]
    assert classify_intersections(a[:, ::-1], b[:, [1, 0, 2]]).tolist() == [case]


def count_cases(a, b):
    pairs = find_intersecting_faces_between(a, b)
    cases = classify_intersections(a.triangles()[pairs[:, 0]], b.triangles()[pairs[:, 1]])
    return [int((cases == case).sum()) for case in (1, 2, 3)]


def test_crossing_tetrahedra_counted_by_hand():
    # the lower corner of the small one sticks out through the bottom of the big one: three sides of b cross face 0 of a
    big, small = tetrahedron(), tetrahedron(0.2, at=(0.2, 0.2, -0.1))
    assert count_cases(big, small) == [3, 0, 0]
    assert count_cases(small, big) == [0, 0, 3]
    # a long thin one lies across the edge on the y axis: its sides cross the two faces there, that edge cuts into it
    across = tetrahedron(0.2, at=(-0.05, 0.4, -0.05))
    assert sum(count_cases(big, across)) == len(find_intersecting_faces_between(big, across))
    assert count_cases(big, across)[1] > 0


def test_corner_of_a_cube_in_the_face_of_another():
    # b's corner (2, 2, 2)-ward tip pierces nothing but the top: b stands on its edges, far from a's edges
    low, high = cube(10.0), cube(1.0, at=(3.2, 6.1, 9.5))
    case_1, case_2, case_3 = count_cases(low, high)
    # four walls of two faces each pass through the top of a, away from its diagonal: 8 faces with one face of a
    assert (case_1, case_2, case_3) == (8, 0, 0)


small = st.integers(-2, 2)


@given(st.lists(small, min_size=18, max_size=18))
def test_a_case_is_found_exactly_where_libigl_finds_an_intersection(numbers):
    corners = np.array(numbers, dtype=float).reshape(2, 3, 3)
    assume(not are_collinear(corners[:, 0], corners[:, 1], corners[:, 2]).any())
    shared = (corners[0][:, None] == corners[1][None]).all(axis=2).any()
    assume(not shared)  # libigl takes equal corners for shared ones
    pairs = find_intersecting_faces(corners.reshape(-1, 3), np.arange(6, dtype=np.int32).reshape(2, 3))
    assert (classify_intersections(corners[:1], corners[1:])[0] != 0) == (len(pairs) == 1)
