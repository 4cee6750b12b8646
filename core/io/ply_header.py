"""The header of a PLY file: which elements follow, and how their numbers are stored."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from core.errors import InputError
from core.io.naming import clean_name

LONGEST_HEADER = 1 << 16
OLD_TYPES = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4", "double": "f8"}
SIZED_TYPES = {
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "float64": "f8",
}
NUMBER_TYPES = OLD_TYPES | SIZED_TYPES
Encoding = Literal["ascii", "binary_little_endian", "binary_big_endian"]
ENCODINGS: tuple[Encoding, ...] = ("ascii", "binary_little_endian", "binary_big_endian")


@dataclass(frozen=True, slots=True)
class Property:
    """One column: a number of NumPy type `type`, or a list of them after a count of type `count_type`."""

    name: str
    type: str
    count_type: str | None = None


@dataclass(frozen=True, slots=True)
class Element:
    """A table of `count` rows."""

    name: str
    count: int
    properties: tuple[Property, ...]

    def find(self, *names: str) -> Property | None:
        """The first property with one of the names."""
        return next((column for column in self.properties if column.name in names), None)


@dataclass(frozen=True, slots=True)
class Header:
    """What the file promises; the rows begin at byte `body`."""

    encoding: Encoding
    elements: tuple[Element, ...]
    body: int


def malformed(message: str, **facts: int) -> InputError:
    """The error for a PLY file that breaks its own rules."""
    error = InputError("ply.malformed", message)
    error.facts.update(facts)
    return error


def parse_header(data: bytes) -> Header:
    """Read up to and including the `end_header` line. Raises: InputError `ply.malformed`, `ply.truncated`."""
    end = data.find(b"\nend_header", 0, LONGEST_HEADER)
    body = data.find(b"\n", end + 1) + 1
    if end < 0 or body == 0:
        raise InputError("ply.truncated", f"no 'end_header' line in the first {min(len(data), LONGEST_HEADER)} bytes")
    lines = [clean_line.split() for clean_line in data[:body].decode("ascii", errors="replace").splitlines()]
    if lines[0] != ["ply"] or lines[-1] != ["end_header"]:
        raise malformed("the header is not framed by the lines 'ply' and 'end_header'")
    encoding: Encoding | None = None
    tables: list[tuple[str, int, list[Property]]] = []
    for number, words in enumerate(lines[1:-1], start=2):
        match words:
            case [] | ["comment" | "obj_info", *_]:
                continue
            case ["format", kind, "1.0"] if kind in ENCODINGS and encoding is None:
                encoding = kind
            case ["element", name, count] if count.isascii() and count.isdigit() and len(count) <= 10:
                tables.append((name, int(count), []))
            case ["property", kind, name] if kind in NUMBER_TYPES and tables:
                tables[-1][2].append(Property(name, NUMBER_TYPES[kind]))
            case ["property", "list", count_kind, kind, name] if _is_list(count_kind, kind) and tables:
                tables[-1][2].append(Property(name, NUMBER_TYPES[kind], NUMBER_TYPES[count_kind]))
            case _:
                raise malformed(f"header line {number} is not understood: {clean_name(' '.join(words))!r}", line=number)
    if encoding is None:
        raise malformed("the header has no line 'format ascii|binary_little_endian|binary_big_endian 1.0'")
    return Header(encoding, tuple(_element(*table) for table in tables), body)


def _is_list(count_kind: str, kind: str) -> bool:
    return kind in NUMBER_TYPES and NUMBER_TYPES.get(count_kind, "f")[0] in "iu"


def _element(name: str, count: int, properties: list[Property]) -> Element:
    names = {column.name for column in properties}
    if not properties or len(names) != len(properties):
        raise malformed(f"element '{clean_name(name)}' has {len(properties)} properties with {len(names)} different names")
    return Element(name, count, tuple(properties))
