"""A place in a gmsh file: lines, runs of numbers and raw rows, never past the end."""

from __future__ import annotations

from mmap import mmap

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.io.naming import clean_name

LONGEST_LINE_BYTES = 4096
MOST_COUNTED = 1 << 40  # counts above are lies, whatever follows


class MshCursor:
    """data: the whole file, mapped. binary: numbers are raw. order: `<` or `>` of raw numbers. at: the next byte."""

    def __init__(self, data: mmap | bytes) -> None:
        self.data = data
        self.binary = False
        self.order = "<"
        self.at = 0

    def line(self) -> str:
        """The next line without its end. Raises: InputError `msh.truncated`."""
        end = self.data.find(b"\n", self.at, self.at + LONGEST_LINE_BYTES)
        if end < 0:
            raise truncated(f"no line ends within {LONGEST_LINE_BYTES} bytes from byte {self.at}")
        text = self.data[self.at : end].decode("latin-1").strip()
        self.at = end + 1
        return text

    def full_line(self) -> str:
        """The next line that is not empty: some programs end raw numbers with a line end, others do not."""
        while not (text := self.line()):
            pass
        return text

    def next_section(self) -> str | None:
        """The name of the section that begins here or after what belongs to none; None at the end of the file."""
        found = self.data.find(b"$", self.at)
        if found < 0:
            return None
        self.at = found
        return self.line().removeprefix("$")

    def end_section(self, name: str) -> None:
        """Raises: InputError `msh.corrupt` if anything else stands here."""
        found = self.full_line()
        if found != f"$End{name}":
            raise corrupt(f"section {name} goes on where it should end, with {clean_name(found)[:40]!r}")

    def skip_section(self, name: str) -> None:
        """To what follows it. Raises: InputError `msh.truncated`."""
        self.at = self._end_of(name)
        self.line()

    def count(self) -> int:
        """A line that is one number of things. Raises: InputError `msh.corrupt`."""
        return counted(self.full_line())

    def numbers(self, name: str) -> NDArray[np.float64]:
        """All numbers of a section of text, up to its end, as one run. Raises: InputError `msh.corrupt`, `msh.truncated`."""
        end = self._end_of(name)
        text, self.at = self.data[self.at : end], end
        try:
            return np.fromstring(text, sep=" ")
        except ValueError as error:
            raise corrupt(f"section {name} has something else than numbers") from error

    def rows(self, layout: np.dtype[np.void] | np.dtype[np.generic], count: int) -> NDArray[np.void]:
        """`count` raw rows. Raises: InputError `msh.truncated` before anything is set aside for them."""
        if count * layout.itemsize > len(self.data) - self.at:
            raise truncated(f"{count} rows of {layout.itemsize} bytes were announced, {len(self.data) - self.at} bytes are left")
        found: NDArray[np.void] = np.frombuffer(self.data[self.at : self.at + count * layout.itemsize], layout)
        self.at += count * layout.itemsize
        return found

    def integers(self, count: int, size: int = 4) -> NDArray[np.int64]:
        """`count` raw whole numbers of 4 or 8 bytes. Raises: InputError `msh.truncated`."""
        return self.rows(np.dtype(f"{self.order}i{size}"), count).astype(np.int64)

    def _end_of(self, name: str) -> int:
        end = self.data.find(f"$End{name}".encode("latin-1"), self.at)
        if end < 0:
            raise truncated(f"section {clean_name(name)[:40]} has no end")
        return end


def counted(text: str) -> int:
    """A whole number from 0 on. Raises: InputError `msh.corrupt`."""
    try:
        number = int(text)
    except ValueError:
        number = -1
    if not 0 <= number < MOST_COUNTED:
        raise corrupt(f"{clean_name(text)[:40]!r} stands where a number of things is wanted")
    return number


def whole(numbers: NDArray[np.float64], what: str) -> NDArray[np.int64]:
    """Raises: InputError `msh.corrupt` unless all are whole numbers."""
    if not (np.isfinite(numbers) & (numbers == np.floor(numbers)) & (np.abs(numbers) < 2.0**53)).all():
        raise corrupt(f"{what} are not all whole numbers")
    return numbers.astype(np.int64)


def corrupt(reason: str) -> InputError:
    """The file contradicts itself or its format."""
    return InputError("msh.corrupt", f"the gmsh file cannot be read: {reason}")


def truncated(reason: str) -> InputError:
    """The file ends too early."""
    return InputError("msh.truncated", f"the gmsh file is cut off: {reason}")
