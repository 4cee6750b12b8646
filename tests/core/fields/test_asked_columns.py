from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from core.field_source import FieldTable
from core.fields.asked_columns import FieldPoints, points_of

ROWS = np.array([[7.0, 1, 2, 3, 4, 5, 6], [8.0, 10, 20, 30, 40, 50, 60]])


def table(*names: str, rows: np.ndarray = ROWS, mm_per_unit: float = 1.0) -> FieldTable:
    return FieldTable(names or ("",) * rows.shape[1], np.ascontiguousarray(rows.T), mm_per_unit)


def require_all(found: FieldPoints) -> None:
    np.testing.assert_array_equal(found.points, ROWS[:, 1:4])
    np.testing.assert_array_equal(found.values, ROWS[:, 4:])


def test_columns_are_named_by_the_caller_or_by_the_header() -> None:
    require_all(points_of(table(), ["-", "x", "y", "z", "Ex", "Ey", "Ez"], "refuse"))
    require_all(points_of(table("id", "X [mm]", "Y", "z", "E_x (V/m)", "ey", "EZ"), None, "refuse"))


def test_any_order_and_names_that_end_early() -> None:
    found = points_of(table(), ["Ez", "z", "Ey", "y", "Ex", "x"], "refuse")
    assert found.points[0].tolist() == [5, 3, 1]
    assert found.values[0].tolist() == [4, 2, 7]


def test_magnitudes_alone() -> None:
    found = points_of(table(), ["magE", "x", "y", "z"], "refuse")
    assert found.values.tolist() == [[7.0], [8.0]]


def test_places_are_in_the_unit_of_the_upload() -> None:
    found = points_of(table(mm_per_unit=1000.0), ["-", "x", "y", "z", "Ex", "Ey", "Ez"], "refuse")
    assert found.points[0].tolist() == [1000, 2000, 3000]
    assert found.values[0].tolist() == [4, 5, 6]


@pytest.mark.parametrize(
    ("names", "columns", "code", "words"),
    [
        ((), None, "fields.columns_missing", "no header for its 7 columns"),
        ((), ["x", "y", "Ex", "Ey"], "fields.columns_missing", "z, Ez: the columns named are x, y, Ex, Ey"),
        (("a", "b", "c", "d", "e", "f", "g"), None, "fields.columns_missing", "header names a, b"),
        ((), ["x", "y", "z", "-", "-", "-", "-"], "fields.columns_missing", "called magE: "),
        ((), ["x", "y", "z", "Ex", "Ey", "-", "-"], "fields.columns_missing", "called Ez: "),
        ((), ["-"] * 8, "fields.columns_differ", "8 columns were named, the file has 7"),
    ],
)
def test_columns_that_are_missing_are_named(names: tuple[str, ...], columns: list[str] | None, code: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        points_of(table(*names), columns, "refuse")
    assert caught.value.code == code


def test_numbers_that_are_none_are_refused_or_counted() -> None:
    rows = np.concatenate([ROWS, ROWS])
    rows[1, 2], rows[3, 5] = np.nan, np.inf
    columns = ["-", "x", "y", "z", "Ex", "Ey", "Ez"]
    with pytest.raises(InputError, match=r"2 of 4 rows .* row 2") as caught:
        points_of(table(rows=rows), columns, "refuse")
    assert caught.value.code == "fields.not_finite"
    found = points_of(table(rows=rows), columns, "leave_out")
    assert (found.rows, found.left_out, found.merged, len(found.points)) == (4, 2, 1, 1)
    with pytest.raises(InputError, match="4 of 4"):
        points_of(table(rows=rows * np.nan), columns, "leave_out")


def test_a_column_that_is_not_used_may_hold_anything() -> None:
    rows = ROWS.copy()
    rows[:, 0] = np.nan
    require_all(points_of(table(rows=rows), ["-", "x", "y", "z", "Ex", "Ey", "Ez"], "refuse"))


def test_rows_at_one_place_are_averaged() -> None:
    rows = np.array([[1.0, 0, 0, 10], [0, 0, 0, 1], [1, 0, 0, 30], [1, 0, 0, 50]])
    found = points_of(table(rows=rows), ["x", "y", "z", "magE"], "refuse")
    assert found.merged == 2
    assert sorted(zip(found.points[:, 0].tolist(), found.values[:, 0].tolist(), strict=True)) == [(0.0, 1.0), (1.0, 30.0)]
