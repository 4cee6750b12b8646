"""ASCII STL: `solid name`, facets of 21 words each, `endsolid name`; one or several solids per file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.errors import InputError
from core.geometry.normals import face_normals
from core.io.naming import clean_name
from core.io.reading import Piece
from core.io.welding import weld
from core.mesh import Mesh

WORDS_PER_FACET = 21
KEYWORDS = {
    0: b"facet",
    1: b"normal",
    5: b"outer",
    6: b"loop",
    7: b"vertex",
    11: b"vertex",
    15: b"vertex",
    19: b"endloop",
    20: b"endfacet",
}
COORDINATE_COLUMNS = (8, 9, 10, 12, 13, 14, 16, 17, 18)
BLOCK_BYTES = 1 << 24  # words cost ten times their text; a block at a time keeps that small
WHITESPACE = re.compile(rb"\s*")
SOLID = re.compile(rb"solid\b")


def read_solids(data: bytes) -> tuple[Piece, ...]:
    """Every solid as a piece of welded float64 vertices; a solid without facets becomes a piece without faces.

    Strict in its words, free in case and white space. Normals are skipped unread: the winding counts.
    Raises: InputError `stl.not_stl`, `stl.truncated`, `stl.malformed`.
    """
    text = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    lower = text.lower()
    pieces: list[Piece] = []
    position = _skip_space(lower, 0)
    while position < len(lower):
        if not SOLID.match(lower, position):
            raise InputError("stl.malformed", f"'solid' expected after {len(pieces)} solids, {_quote(lower[position:])} found")
        line_end = lower.find(b"\n", position)
        body = len(lower) if line_end < 0 else line_end
        name = clean_name(text[position + len(b"solid") : body])
        end = lower.find(b"endsolid", body)
        if end < 0:
            raise _unfinished(lower[body:], name)
        corners = np.concatenate([np.empty((0, 9)), *_parse_facets(lower[body:end])])
        vertices, index = weld(corners.reshape(-1, 3))
        pieces.append(Piece(name, vertices, index.reshape(-1, 3)))
        line_end = lower.find(b"\n", end)
        position = len(lower) if line_end < 0 else _skip_space(lower, line_end)
    return tuple(pieces)


def write(mesh: Mesh, path: Path, name: str) -> None:
    """Write the shortest decimals that read back as the same float64. Same mesh and name, same bytes."""
    points = [f"vertex {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    normals = [f"{x:.7g} {y:.7g} {z:.7g}" for x, y, z in face_normals(mesh.vertices, mesh.faces).tolist()]
    title = clean_name(name).encode("ascii", errors="replace").decode()
    with path.open("w", encoding="ascii", newline="\n") as file:
        file.write(f"solid {title}\n")
        file.writelines(
            f"facet normal {normal}\nouter loop\n{points[a]}\n{points[b]}\n{points[c]}\nendloop\nendfacet\n"
            for normal, (a, b, c) in zip(normals, mesh.faces.tolist(), strict=True)
        )
        file.write(f"endsolid {title}\n")


def _skip_space(text: bytes, position: int) -> int:
    match = WHITESPACE.match(text, position)
    return match.end() if match else position


def _unfinished(rest: bytes, name: str) -> InputError:
    """The error for a solid without end: a cut file, or prose that begins with the word solid."""
    if rest.split(maxsplit=1)[:1] != [b"facet"]:
        return InputError("stl.not_stl", f"the file begins with 'solid' but goes on with {_quote(rest)}, not with a facet")
    whole = rest.count(b"endfacet")
    return InputError("stl.truncated", f"the file ends inside solid '{name}' after {whole} whole facets", whole_facets=whole)


def _parse_facets(body: bytes) -> Iterator[NDArray[np.float64]]:
    """Corner coordinates (n, 9) of one block of facets after the other."""
    start = facets = 0
    while start < len(body):
        cut = body.find(b"endfacet", start + BLOCK_BYTES)
        stop = len(body) if cut < 0 else cut + len(b"endfacet")
        block = body[start:stop]
        words = block.split()
        yield _parse_block(words, facets, plain=b"_" not in block)
        facets += len(words) // WORDS_PER_FACET
        start = stop


def _parse_block(words: list[bytes], first_facet: int, *, plain: bool) -> NDArray[np.float64]:
    """Check all keywords, then convert all numbers; only a bad block, or one not `plain`, is looked at word by word."""
    count, rest = divmod(len(words), WORDS_PER_FACET)
    if rest or any(words[column::WORDS_PER_FACET].count(word) != count for column, word in KEYWORDS.items()):
        raise _misplaced_word(words, first_facet)
    corners = np.empty((count, 9))
    for place, column in enumerate(COORDINATE_COLUMNS):
        numbers = words[column::WORDS_PER_FACET]
        if not plain and not all(map(_is_number, numbers)):
            raise _no_number(numbers, first_facet)
        try:
            corners[:, place] = np.fromiter(map(float, numbers), np.float64, count)
        except ValueError:
            raise _no_number(numbers, first_facet) from None
    return corners


def _misplaced_word(words: list[bytes], first_facet: int) -> InputError:
    for place, word in enumerate(words):
        wanted = KEYWORDS.get(place % WORDS_PER_FACET)
        if wanted and word != wanted:
            facet = first_facet + place // WORDS_PER_FACET
            return InputError(
                "stl.malformed", f"facet {facet} (from 0): '{wanted.decode()}' expected, {_quote(word)} found", facet=facet
            )
    facet = first_facet + len(words) // WORDS_PER_FACET
    return InputError(
        "stl.malformed",
        f"facet {facet} (from 0) has {len(words) % WORDS_PER_FACET} words instead of {WORDS_PER_FACET}",
        facet=facet,
    )


def _no_number(numbers: list[bytes], first_facet: int) -> InputError:
    facet, word = next((place, word) for place, word in enumerate(numbers, start=first_facet) if not _is_number(word))
    return InputError("stl.malformed", f"facet {facet} (from 0): {_quote(word)} is not a number", facet=facet)


def _is_number(word: bytes) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return b"_" not in word  # Python reads 1_000, STL does not know it


def _quote(text: bytes) -> str:
    return repr(clean_name(text[:24]))
