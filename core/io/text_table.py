"""Matrices of numbers as text, as MATLAB, gmsh and spreadsheets write them: any delimiter, with or without a header."""

from __future__ import annotations

import re
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError, LimitError
from core.io.naming import clean_name

EXTENSIONS = (".csv", ".txt", ".tsv", ".dat")
COMMENT_MARKS = ("#", "%", "//", "!")
HEAD_LINES = 200  # within so many lines the numbers begin
LONGEST_LINE_BYTES = 1 << 20
MOST_NUMBERS = 128_000_000  # 1 GB
PIECE_BYTES = 4 << 20
DELIMITERS = (";", "\t", ",")
_DECIMAL_COMMA = re.compile(r"^\s*[-+]?\d+,\d+\s*$")


@dataclass(frozen=True, eq=False, slots=True)
class TextTable:
    """names: one per column, empty where there is no header. columns: (K, N) float64."""

    names: tuple[str, ...]
    columns: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class _Layout:
    """Lines before the numbers, what parts them (None: blanks), how a comment begins, names of columns.

    closed: a delimiter ends each line, too, and begins no column."""

    skip: int
    delimiter: str | None
    comment: str
    names: tuple[str, ...]
    closed: bool

    @property
    def width(self) -> int:
        """Columns."""
        return len(self.names)


def read_table(path: Path, skip: int = 0) -> TextTable:
    """All columns of what follows the first `skip` lines.

    Raises: InputError `table.binary`, `table.empty`, `table.line_too_long`, `table.not_numbers`, `table.ragged`,
    `table.decimal_comma`; LimitError `table.too_large`.
    """
    lines = _count_lines(path)
    layout = _find_layout(path, skip)
    if lines * layout.width > MOST_NUMBERS:
        raise LimitError(
            "table.too_large",
            f"{lines} lines of {layout.width} columns are more than the {MOST_NUMBERS} numbers that are read; "
            "leave columns out that are not needed",
            lines=lines,
            columns=layout.width,
        )
    try:
        rows = np.loadtxt(
            path,
            delimiter=layout.delimiter,
            comments=layout.comment,
            skiprows=layout.skip,
            usecols=range(layout.width) if layout.closed else None,
            ndmin=2,
            encoding="latin-1",
        )
    except ValueError as error:
        raise _named(error, layout) from error
    return TextTable(layout.names, np.ascontiguousarray(rows.T))


def _count_lines(path: Path) -> int:
    """Without a line being held in memory. A byte 0 is in no text."""
    count, length, longest = 0, 0, 0
    with path.open("rb") as file:
        while piece := file.read(PIECE_BYTES):
            if b"\0" in piece:
                raise InputError("table.binary", "the file has bytes that are no text: a matrix of numbers as text is wanted")
            ends = np.flatnonzero(np.frombuffer(piece, np.uint8) == ord("\n"))
            count += len(ends)
            if len(ends):
                longest = max(longest, length + int(ends[0]), int(np.diff(ends).max(initial=0)))
                length = len(piece) - int(ends[-1]) - 1
            else:
                length += len(piece)
            longest = max(longest, length)
            if longest > LONGEST_LINE_BYTES:
                raise InputError(
                    "table.line_too_long",
                    f"line {count + 1} or one before it has more than {LONGEST_LINE_BYTES} bytes: a row per point is wanted",
                    most_bytes=LONGEST_LINE_BYTES,
                )
    return count + 1


def _find_layout(path: Path, skip: int) -> _Layout:
    """From the first line of numbers and what stands before it."""
    heads: list[str] = []
    comment, seen = "#", ""
    with path.open(encoding="latin-1") as file:
        for number, line in enumerate(islice(file, skip, skip + HEAD_LINES), start=skip):
            text = line.strip().lstrip("\ufeff").removeprefix("ï»¿")
            mark = next((mark for mark in COMMENT_MARKS if text.startswith(mark)), None)
            if mark is not None:
                comment = mark
                text = text.lstrip("#%/! ")
            if not text:
                continue
            delimiter = next((each for each in DELIMITERS if each in text), None)
            delimiter = None if delimiter == "\t" else delimiter
            cells = _cells(text, delimiter)
            if mark is None and all(_is_number(cell) for cell in cells):
                closed = delimiter is not None and len(cells) < text.count(delimiter) + 1
                return _Layout(number, delimiter, comment, _names(heads, len(cells)), closed)
            if mark is None and all(_DECIMAL_COMMA.match(cell) or _is_number(cell) for cell in cells):
                raise InputError("table.decimal_comma", f"line {number + 1} has decimal commas ({text[:60]!r}): write points")
            heads.append(text)
            seen = seen or (text if mark is None else "")
    if seen:
        raise InputError("table.not_numbers", f"no line of numbers among the first {HEAD_LINES}; the file begins {seen[:60]!r}")
    raise InputError("table.empty", "the file has no numbers")


def _cells(text: str, delimiter: str | None) -> list[str]:
    """A delimiter at the end of a line begins no column."""
    parts = text.split() if delimiter in (None, "\t") else text.split(delimiter)
    return parts[:-1] if len(parts) > 1 and not parts[-1].strip() else parts


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return "_" not in cell


def _names(heads: list[str], width: int) -> tuple[str, ...]:
    """The last line before the numbers that has a word for every column names them."""
    for head in reversed(heads):
        cells = _cells(head, next((each for each in DELIMITERS if each in head), None))
        if len(cells) == width:
            return tuple(clean_name(cell.strip().strip("\"'")) for cell in cells)
    return ("",) * width


def _named(error: ValueError, layout: _Layout) -> InputError:
    text = str(error)
    row = re.search(r"at row (\d+)", text)
    is_ragged = "columns changed" in text or "invalid column index" in text
    line = layout.skip + (int(row[1]) if row else 0) + (not is_ragged)  # NumPy counts rows from 1 there and from 0 here
    if is_ragged:
        return InputError("table.ragged", f"line {line} or near it has not the {layout.width} columns of the others", line=line)
    cell = re.search(r"string '(.*?)' to", text)
    what = f"{clean_name(cell[1])!r} instead of a number" if cell else clean_name(text)
    return InputError("table.not_numbers", f"line {line} or near it has {what}", line=line)
