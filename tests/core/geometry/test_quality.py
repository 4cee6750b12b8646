import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.geometry.quality import quality, side_lengths

ONE_FACE = np.array([[0, 1, 2]], dtype=np.int32)


def q_of(a, b, c):
    return float(quality(np.array([a, b, c], dtype=float), ONE_FACE)[0])


def test_closed_forms():
    assert q_of([0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0]) == pytest.approx(1.0, abs=1e-15)
    # right-angled isosceles (thesis Fig. 16): q = 2 (cos 90° + 2 cos 45° - 1)
    assert q_of([0, 0, 0], [5, 0, 0], [0, 5, 0]) == pytest.approx(2 * (np.sqrt(2) - 1), rel=1e-14)
    # 3-4-5: r_in = 1, r_out = 2.5
    assert q_of([0, 0, 0], [3, 0, 0], [0, 0, 4]) == pytest.approx(0.8, rel=1e-14)
    assert q_of([0, 0, 0], [1, 1, 1], [2, 2, 2]) == 0.0
    assert q_of([1, 1, 1], [1, 1, 1], [1, 1, 1]) == 0.0


@given(st.lists(st.floats(-100, 100), min_size=9, max_size=9))
def test_equals_the_formula_of_the_thesis(numbers):
    points = np.round(np.array(numbers).reshape(3, 3), 3)
    a, b, c = side_lengths(points, ONE_FACE)[0]
    q = float(quality(points, ONE_FACE)[0])
    assert 0.0 <= q <= 1.0
    if min(a, b, c) > 0:
        assert q == pytest.approx((b + c - a) * (c + a - b) * (a + b - c) / (a * b * c), abs=1e-9)


def test_a_needle_keeps_its_digits():
    height = 1e-9
    # base 2, apex over its middle: q = 16 A² / (abc (a+b+c)) with A = height
    side = np.hypot(1.0, height)
    expected = 16 * height**2 / (2 * side**2 * (2 + 2 * side))
    assert q_of([-1, 0, 0], [1, 0, 0], [0, height, 0]) == pytest.approx(expected, rel=1e-12)


def test_side_lies_opposite_its_corner():
    lengths = side_lengths(np.array([[0, 0, 0], [3, 0, 0], [0, 4, 0]], dtype=float), ONE_FACE)
    assert lengths.tolist() == [[5.0, 4.0, 3.0]]
