from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.io import stl, stl_ascii
from tests.core.io.tiny import TETRAHEDRON, jagged

ONE = b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
TWO = ONE.replace(b"vertex 0 0 0", b"vertex 1 1 0")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "upload"


def test_several_solids_keep_their_names() -> None:
    skin, unnamed = stl_ascii.read_solids(b"solid left ear (outer)\n" + ONE + TWO + b"endsolid\nsolid\n" + ONE + b"endsolid x\n")
    assert (skin.name, len(skin.faces), len(skin.vertices)) == ("left ear (outer)", 2, 4)
    assert (unnamed.name, len(unnamed.faces)) == ("", 1)


def test_case_white_space_and_line_ends_are_free() -> None:
    text = b"  Solid Endfacet solid\r\n" + ONE.upper().replace(b"\n", b"\r\n\t") + b"ENDSOLID"
    (piece,) = stl_ascii.read_solids(text)
    assert piece.name == "Endfacet solid"
    assert piece.vertices[piece.faces].tolist() == [[[0, 0, 0], [1, 0, 0], [0, 1, 0]]]


def test_normals_are_not_read() -> None:
    (piece,) = stl_ascii.read_solids(b"solid\n" + ONE.replace(b"0 0 1", b"-nan(ind) 1.#QNAN 0,5") + b"endsolid\n")
    assert len(piece.faces) == 1


def test_facets_are_numbered_over_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stl_ascii, "BLOCK_BYTES", 150)
    (piece,) = stl_ascii.read_solids(b"solid\n" + ONE * 9 + b"endsolid\n")
    assert len(piece.faces) == 9
    with pytest.raises(InputError, match=r"facet 8 \(from 0\): 'vertex' expected, 'vortex' found"):
        stl_ascii.read_solids(b"solid\n" + ONE * 8 + ONE.replace(b"vertex 1", b"vortex 1") + b"endsolid\n")


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        (b"solid\n" + ONE + ONE[:60], "stl.truncated", "after 1 whole facets"),
        (b"solid\n" + ONE[:-10] + b"endsolid\n", "stl.malformed", "20 words instead of 21"),
        (b"solid\n" + ONE.replace(b"1 0 0", b"1 0 zero") + b"endsolid\n", "stl.malformed", "'zero' is not a number"),
        (b"solid\n" + ONE.replace(b"1 0 0", b"1 0 1_0") + b"endsolid\n", "stl.malformed", "'1_0' is not a number"),
        (b"solid\n" + ONE.replace(b"1 0 0", b"1 0 0 0") + b"endsolid\n", "stl.malformed", "'vertex' expected, '0' found"),
        (b"solid\n" + ONE + b"endsolid\nthanks for reading\n", "stl.malformed", "'thanks for reading' found"),
    ],
)
def test_broken_grammar_is_refused_with_its_place(file: Path, text: bytes, code: str, words: str) -> None:
    file.write_bytes(text)
    with pytest.raises(InputError) as caught:
        stl.read(file)
    assert caught.value.code == code
    assert words in caught.value.message


def test_a_solid_without_facets_is_left_out_and_told(file: Path) -> None:
    file.write_bytes(b"\xef\xbb\xbfsolid ghost\nendsolid ghost\nsolid real\n" + ONE + b"endsolid real\n")
    reading = stl.read(file)
    assert [piece.name for piece in reading.pieces] == ["real"]
    assert [(finding.code, finding.count) for finding in reading.findings] == [("stl.empty_solid", 1)]
    assert "ghost" in reading.findings[0].message


def test_writing_keeps_every_bit_and_is_deterministic(file: Path) -> None:
    stl_ascii.write(jagged(), file, "ear\nsolid")
    first = file.read_bytes()
    (piece,) = stl.read(file).pieces
    assert piece.name == "ear solid"
    assert np.array_equal(piece.vertices[piece.faces], jagged().triangles())
    stl_ascii.write(jagged(), file, "ear\nsolid")
    assert file.read_bytes() == first


def test_written_normals_follow_the_winding(file: Path) -> None:
    stl_ascii.write(TETRAHEDRON, file, "t")
    assert b"facet normal 0 0 -1\nouter loop\nvertex 0.0 0.0 0.0\nvertex 0.0 100.0 0.0\n" in file.read_bytes()
