from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.io import obj
from core.io.reading import Reading
from tests.core.io.tiny import CORNERS_MM, TRIANGLES, jagged

TEXT = "v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "upload"


def read(file: Path, text: str) -> Reading:
    file.write_text(text, newline="")
    return obj.read(file)


@pytest.mark.parametrize(
    "text",
    [
        TEXT,
        TEXT.replace("\n", "\r\n"),
        "# a comment\nmtllib ../../etc/passwd\no skin\ng left\ns off\nvn 0 0 1\nvt 0 0\nusemtl red\n\n" + TEXT,
        TEXT.replace("f 1 3 2", "f 1/1/1 3//2 2/4"),
        TEXT.replace("f 1 3 2", "f -4 -2 -3"),
        TEXT.replace("f 1 3 2", "f 1 \\\n 3 2"),
        TEXT.replace("v 0 0 0", "v 0 0 0 0.5 0.5 1.0"),
        "\n".join(reversed(TEXT.splitlines()[4:])) + "\n" + "\n".join(TEXT.splitlines()[:4]),
    ],
)
def test_only_v_and_f_count(file: Path, text: str) -> None:
    (piece,) = read(file, text).pieces
    assert np.array_equal(piece.vertices, CORNERS_MM)
    assert sorted(piece.faces.tolist()) == sorted(TRIANGLES)


def test_polygons_become_fans_and_are_told(file: Path) -> None:
    reading = read(file, TEXT.replace("f 2 3 4", "f 2 3 4 1"))
    assert reading.pieces[0].faces.tolist()[2:4] == [[1, 2, 3], [1, 3, 0]]
    assert [(finding.code, finding.count) for finding in reading.findings] == [("mesh.polygons_split", 1)]


def test_unused_vertices_go_and_double_ones_stay_and_both_are_told(file: Path) -> None:
    reading = read(file, "v 7 7 7\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 2 3 4\nf 5 7 6\n")
    (piece,) = reading.pieces
    assert (piece.vertices.tolist()[0], piece.faces.tolist()) == ([0, 0, 0], [[0, 1, 2], [3, 5, 4]])
    assert [(finding.code, finding.count) for finding in reading.findings] == [
        ("mesh.unused_vertices", 1),
        ("mesh.coincident_vertices", 2),
    ]


def test_writing_keeps_every_bit_and_is_deterministic(file: Path) -> None:
    obj.write(jagged(), file, "skin\nf 1 1 1")
    first = file.read_bytes()
    (piece,) = obj.read(file).pieces
    assert piece.vertices.tobytes() == jagged().vertices.tobytes()
    assert np.array_equal(piece.faces, TRIANGLES)
    obj.write(jagged(), file, "skin\nf 1 1 1")
    assert file.read_bytes() == first


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("v 1 2\n", "obj.malformed", "line 1: a vertex of 2 numbers"),
        (TEXT + "f 1 2\n", "obj.malformed", "line 9: a face of 2 corners"),
        (TEXT.replace("f 1 3 2", "f 1 three 2"), "obj.malformed", "line 5: "),
        (TEXT.replace("v 100", "v 1_00"), "obj.malformed", "line 2: a word is not a number"),
        (TEXT.replace("v 100", "v 1,5"), "obj.malformed", "line 2: "),
        (TEXT.replace("f 1 3 2", "f 1.0 3 2"), "obj.malformed", "line 5: "),
        (TEXT.replace("f 1 3 2", f"f {10**30} 3 2"), "obj.malformed", "line 5: an index is larger than 9007199254740992"),
        (TEXT + "curv 0 1\n", "obj.malformed", "line 9: unknown statement 'curv'"),
        ("Dear colleague,\n", "obj.malformed", "line 1: unknown statement 'Dear'"),
        (TEXT.replace("f 1 3 2", "f 0 2 1"), "obj.zero_based", "index 0"),
        (TEXT.replace("f 1 3 2", "f 1 3 5"), "mesh.index_out_of_range", "run from 1 to 5, 4 vertices allow 1 to 4"),
        (TEXT.replace("f 1 3 2", "f 1 3 -9"), "mesh.index_out_of_range", "run from -4 to 4"),
        ("v 1 2 3\n", "mesh.empty", "1 vertices and 0 faces"),
        ("# nothing\n", "mesh.empty", "0 vertices and 0 faces"),
    ],
)
def test_what_is_no_obj_is_refused_with_its_line(file: Path, text: str, code: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        read(file, text)
    assert (caught.value.code, words in caught.value.message) == (code, True), caught.value.message
