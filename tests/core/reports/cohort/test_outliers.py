"""Outliers by median and median absolute deviation: worked out by hand."""

from __future__ import annotations

import pytest

from core.reports.cohort.outliers import find_outliers, summarize_column


def named(*values: float) -> dict[str, float]:
    return {f"s{number}": value for number, value in enumerate(values)}


def test_one_far_number_is_named_with_its_distance() -> None:
    # median 3.5, deviations 2.5 1.5 0.5 0.5 1.5 96.5, their median 1.5: 96.5 / (1.4826 * 1.5) = 43.4
    [found] = find_outliers("fat.min_mm", named(1, 2, 3, 4, 5, 100))
    assert (found.subject, found.value, found.median, found.deviations) == ("s5", 100, 3.5, 43.39)
    assert found.reason == "fat.min_mm is 100, 43.4 robust deviations above the median 3.5 of 6 subjects"


def test_two_giants_do_not_hide_each_other() -> None:
    """Mean and standard deviation would: of these numbers both giants lie below 2 deviations."""
    assert [found.subject for found in find_outliers("x", named(10, 11, 9, 10, 12, 11, 500, 510))] == ["s6", "s7"]


def test_below_is_told_as_below() -> None:
    [found] = find_outliers("x", named(10, 11, 9, 10, 12, -40))
    assert found.deviations < -3.5
    assert "below the median" in found.reason


def test_among_equal_numbers_another_one_is_far() -> None:
    # the median deviation is 0; the mean one 7 / 6: 7 / (1.2533 * 7 / 6) = 4.79
    [found] = find_outliers("genus", named(0, 0, 0, 7, 0, 0))
    assert (found.subject, found.deviations) == ("s3", 4.79)


def test_half_and_half_is_no_outlier() -> None:
    assert find_outliers("genus", named(0, 0, 0, 1, 1, 1)) == []


@pytest.mark.parametrize(
    "values",
    [
        (5.0, 5.0, 5.0, 5.0, 5.0),
        (1.0, 1.0, 1.0, 900.0),  # four are too few
        (1e6, 1e6, 1e6, 1e6, 1e6, 1e6 + 0.5),  # below a millionth: rounding
        (),
    ],
)
def test_nothing_is_far(values: tuple[float, ...]) -> None:
    assert find_outliers("x", named(*values)) == []


def test_a_column_is_summarized_by_what_no_single_number_moves() -> None:
    told = summarize_column(named(1, 2, 3, 4, 100))
    assert (told.count, told.minimum, told.median, told.maximum) == (5, 1, 3, 100)
    assert told.spread == pytest.approx(1.4826)
