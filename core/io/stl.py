"""STL of either kind: the gate that decides by size first, so a binary file may begin with `solid`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.errors import InputError
from core.io import stl_ascii, stl_binary
from core.io.reading import Reading
from core.schema.finding import Finding, Severity

HEAD_BYTES = 1024
UTF8_MARK = b"\xef\xbb\xbf"


def read(path: Path) -> Reading:
    """Read binary iff the size is exactly 84 + 50 n bytes (or zeros follow, which is told); else strict ASCII.

    Raises: InputError `stl.not_stl`, `stl.count_mismatch`, `stl.truncated`, `stl.malformed`, `mesh.empty`.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        head = file.read(HEAD_BYTES)
    count = stl_binary.declared_count(head)
    surplus = size - stl_binary.file_size(count)
    if (size >= stl_binary.PREFIX_BYTES and surplus == 0) or (count > 0 and surplus > 0 and _ends_in_zeros(path, surplus)):
        if count == 0:
            raise InputError("mesh.empty", "the binary STL declares 0 facets")
        return Reading((stl_binary.read_facets(path, count),), tuple(_check_padding(surplus)))
    text = head.removeprefix(UTF8_MARK).lstrip()
    if text[:5].lower() == b"solid" and b"\0" not in head:
        return _read_ascii(path)
    if _is_text(head):
        raise InputError("stl.not_stl", f"the file is text of {size} bytes that does not begin with 'solid'", bytes=size)
    raise stl_binary.size_error(size, count)


def _read_ascii(path: Path) -> Reading:
    solids = stl_ascii.read_solids(path.read_bytes().removeprefix(UTF8_MARK))
    filled = tuple(solid for solid in solids if len(solid.faces))
    if not filled:
        raise InputError("mesh.empty", f"none of the {len(solids)} solids of the ASCII STL has a facet")
    empty = [solid.name or "unnamed" for solid in solids if not len(solid.faces)]
    if not empty:
        return Reading(filled)
    message = f"{len(empty)} solids without facets were left out: {', '.join(empty[:10])}"
    return Reading(filled, (Finding(code="stl.empty_solid", severity=Severity.WARNING, message=message, count=len(empty)),))


def _ends_in_zeros(path: Path, surplus: int) -> bool:
    """True if the last `surplus` bytes are zero: some exporters pad to whole blocks."""
    tail = np.memmap(path, dtype=np.uint8, mode="r")[-surplus:]
    return not tail.any()


def _check_padding(surplus: int) -> list[Finding]:
    if surplus == 0:
        return []
    message = f"{surplus} zero bytes after the last facet were ignored"
    return [Finding(code="stl.trailing_zeros", severity=Severity.INFO, message=message, count=surplus)]


def _is_text(head: bytes) -> bool:
    """True if nearly all bytes are printable ASCII or white space, and none is zero as in the count of a cut-off binary."""
    if b"\0" in head:
        return False
    printable = sum(32 <= byte < 127 or byte in b"\t\n\r\f" for byte in head)
    return printable >= 0.95 * len(head)
