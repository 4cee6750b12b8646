from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError, LimitError
from core.io import text_table
from core.io.text_table import read_table

ROWS = [[1.0, -2.5, 3e3, 4.0], [5.0, 6.0, 7.0, 8.0]]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "field.txt"


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("x,y,z,E\n1,-2.5,3e3,4\n5,6,7,8\n", ("x", "y", "z", "E")),
        ('"x" ; "y";z;E\r\n1;-2.5;3e3;4\r\n5;6;7;8\r\n', ("x", "y", "z", "E")),
        ("% x y z E\n% written by hand\n1 -2.5 3e3 4\n\n5 6 7 8", ("x", "y", "z", "E")),
        ("1\t-2.5\t3000\t4\n# between\n5\t6\t7\t8\n", ("", "", "", "")),
        ("  1   -2.5 3e3 4  \n5 6 7 8  \n", ("", "", "", "")),
        ("# two words\n1,-2.5, 3e3 ,4,\n5,6,7,8,\n", ("", "", "", "")),
        ("\ufeffx,y,z,E\n1,-2.5,3e3,4\n5,6,7,8\n", ("x", "y", "z", "E")),
    ],
)
def test_delimiters_headers_and_comments(file: Path, text: str, names: tuple[str, ...]) -> None:
    file.write_text(text, encoding="utf-8")
    table = read_table(file)
    assert table.names == names
    assert table.columns.T.tolist() == ROWS


def test_nan_and_infinity_are_numbers(file: Path) -> None:
    file.write_text("1 NaN\nInf -inf\n")
    np.testing.assert_array_equal(read_table(file).columns, [[1.0, np.inf], [np.nan, -np.inf]])


@pytest.mark.parametrize(
    ("data", "code", "words"),
    [
        (b"", "table.empty", "no numbers"),
        (b"# only words\n", "table.empty", "no numbers"),
        (b"hello\n", "table.not_numbers", "hello"),
        (b"1,2,3\n4,5,6\n7,x,9\n", "table.not_numbers", "line 3 .* 'x'"),
        (b"a,b,c\n1,2,3\n4,,6\n", "table.not_numbers", "line 3 .* ''"),
        (b"1,2,3\n4,5\n", "table.ragged", "line 2"),
        (b"1 2 3\n4 5 6 7\n", "table.ragged", "line 2"),
        (b"1,5;2,5\n", "table.decimal_comma", "points"),
        (b"1 2\n\0\n", "table.binary", "text"),
        (b"1 " * 600_000, "table.line_too_long", "1048576"),
    ],
)
def test_what_is_no_matrix_is_named(file: Path, data: bytes, code: str, words: str) -> None:
    file.write_bytes(data)
    with pytest.raises(InputError, match=words) as caught:
        read_table(file)
    assert caught.value.code == code


def test_a_matrix_is_refused_before_it_is_read_if_it_is_too_large(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file.write_text("1 2 3\n" * 100)
    monkeypatch.setattr(text_table, "MOST_NUMBERS", 300)
    with pytest.raises(LimitError, match="101 lines of 3 columns") as caught:
        read_table(file)
    assert caught.value.code == "table.too_large"


def test_long_files_are_read_in_pieces(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(text_table, "PIECE_BYTES", 7)
    file.write_text("10 20\n30 40\n50 60\n")
    assert read_table(file).columns.tolist() == [[10, 30, 50], [20, 40, 60]]
    monkeypatch.setattr(text_table, "LONGEST_LINE_BYTES", 4)
    with pytest.raises(InputError, match="more than 4 bytes"):
        read_table(file)
