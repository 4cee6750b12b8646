from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from core.io.welding import weld


def test_equal_points_become_one_in_order_of_first_appearance() -> None:
    points = np.array([[5.0, 0, 0], [1, 0, 0], [5, 0, 0], [0, 0, 0], [1, 0, 0]])
    vertices, index = weld(points)
    assert vertices.tolist() == [[5, 0, 0], [1, 0, 0], [0, 0, 0]]
    assert index.tolist() == [0, 1, 0, 2, 1]


def test_the_two_zeros_are_one_and_keep_the_first_sign() -> None:
    vertices, index = weld(np.array([[-0.0, 0.0, 0.0], [0.0, 0.0, -0.0]], dtype=np.float32))
    assert index.tolist() == [0, 0]
    assert np.signbit(vertices).tolist() == [[True, False, False]]


def test_neighbouring_floats_stay_apart() -> None:
    one = np.float32(1.0)
    vertices, _ = weld(np.array([[one, 0, 0], [np.nextafter(one, np.float32(2)), 0, 0]], dtype=np.float32))
    assert len(vertices) == 2


def test_nothing_welds_to_nothing() -> None:
    vertices, index = weld(np.empty((0, 3)))
    assert len(vertices) == len(index) == 0


@given(
    hnp.arrays(np.float64, st.tuples(st.integers(0, 40), st.just(3)), elements=st.sampled_from([-1.5, -0.0, 0.0, 1e-320, 7.0]))
)
def test_welding_is_lossless_and_complete(points: np.ndarray) -> None:
    vertices, index = weld(points)
    assert np.array_equal(vertices[index], points)
    assert len(vertices) == len({tuple(point) for point in points.tolist()})
