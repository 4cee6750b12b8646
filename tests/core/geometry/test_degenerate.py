import numpy as np

from core.geometry.degenerate import find_degenerate_faces
from tests.solids import sphere


def test_corner_twice_three_in_line_and_slivers():
    vertices = np.array([[0, 0, 0], [1, 1, 1], [3, 3, 3], [0, 0, 1e-30], [1, 2, 3], [1, 2, 3]], dtype=float)
    faces = np.array([[0, 0, 1], [0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 4, 5]], dtype=np.int32)
    assert find_degenerate_faces(vertices, faces).tolist() == [0, 1, 4]


def test_far_from_the_origin_nothing_is_rounded_to_zero():
    # float arithmetic gives this triangle no area: its sides are one step of float64 long
    step = np.spacing(1e7)
    vertices = np.array([[1e7, 1e7, 1e7], [1e7 + step, 1e7, 1e7], [1e7, 1e7 + step, 1e7], [1e7 + 2 * step, 1e7, 1e7]])
    assert find_degenerate_faces(vertices, np.array([[0, 1, 2], [0, 1, 3]], dtype=np.int32)).tolist() == [1]


def test_a_sphere_has_none():
    assert len(find_degenerate_faces(sphere().vertices, sphere().faces)) == 0
