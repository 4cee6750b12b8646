from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.geometry.exact_predicates import are_collinear, orient2d, orient3d

# multiples of a tiny step far from the origin: float determinants are mostly noise
noisy = st.integers(-3, 3).map(lambda k: 12.0 + k * 2.0**-48)
wild = st.floats(-1e7, 1e7, allow_subnormal=True)
number = st.one_of(noisy, wild, st.sampled_from([0.0, -0.0, 0.1, 0.3, 5e-324, -2.2250738585072014e-308]))


def rows(count, size):
    return st.lists(st.lists(number, min_size=size, max_size=size), min_size=count, max_size=count)


def sign(value):
    return (value > 0) - (value < 0)


def fraction_determinant(rows_):
    if len(rows_) == 1:
        return rows_[0][0]
    return sum(
        (-1) ** j * head * fraction_determinant([row[:j] + row[j + 1 :] for row in rows_[1:]]) for j, head in enumerate(rows_[0])
    )


def exact_sign(points):
    """Sign of the determinant of the differences to the last point, in fractions."""
    *heads, last = [[Fraction(value) for value in point] for point in points]
    return sign(fraction_determinant([[h - o for h, o in zip(head, last, strict=True)] for head in heads]))


@given(rows(3, 2))
def test_orient2d_is_exact(points):
    assert orient2d(*(np.array([point]) for point in points))[0] == exact_sign(points)


@given(rows(4, 3))
def test_orient3d_is_exact(points):
    assert orient3d(*(np.array([point]) for point in points))[0] == -exact_sign(points)


def test_signs_mean_what_they_say():
    a, b, c = np.eye(3)[[0]], np.eye(3)[[1]], np.zeros((1, 3))
    assert orient2d(c[:, :2], a[:, :2], b[:, :2]).tolist() == [1]
    assert orient3d(c, a, b, np.array([[0, 0, 1.0]])).tolist() == [1]
    assert orient3d(c, a, b, np.array([[0, 0, -1.0]])).tolist() == [-1]
    assert orient3d(c, a, b, np.array([[9, 9, 0.0]])).tolist() == [0]


def test_plain_arithmetic_gets_these_wrong():
    # (k·ulp steps on the diagonal) the classic picture of naive orientation errors
    step = 2.0**-53
    p = np.array([[0.5 + i * step, 0.5 + j * step] for i in range(32) for j in range(32)])
    q, r = np.full_like(p, 12.0), np.full_like(p, 24.0)
    naive = np.sign((p[:, 0] - r[:, 0]) * (q[:, 1] - r[:, 1]) - (p[:, 1] - r[:, 1]) * (q[:, 0] - r[:, 0]))
    signs = orient2d(p, q, r)
    assert signs.tolist() == np.sign(p[:, 1] - p[:, 0]).tolist()  # seen from a point above the diagonal
    assert (naive != signs).any()


@pytest.mark.parametrize(
    ("third", "expected"),
    [([2, 2, 2], True), ([1, 1, 1], True), ([0, 0, 0], True), ([2, 2, 2 + 2**-50], False), ([2, 2 + 2**-50, 2], False)],
)
def test_are_collinear(third, expected):
    assert are_collinear(np.zeros((1, 3)), np.ones((1, 3)), np.array([third], dtype=float)).tolist() == [expected]
