from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.io import ply
from core.io.reading import Reading
from tests.core.io.tiny import CORNERS_MM, TRIANGLES, jagged

HEADER = "ply\nformat {} 1.0\ncomment by hand\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
FACES = "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
ASCII_BODY = "0 0 0\n100 0 0\n0 100 0\n0 0 100\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
ASCII = HEADER.format("ascii") + FACES + ASCII_BODY


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "upload"


def read(file: Path, content: bytes | str) -> Reading:
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    return ply.read(file)


def is_tetrahedron(reading: Reading) -> bool:
    (piece,) = reading.pieces
    return np.array_equal(piece.vertices, CORNERS_MM) and np.array_equal(piece.faces, TRIANGLES)


def test_ascii_is_read_with_any_line_ends(file: Path) -> None:
    assert is_tetrahedron(read(file, ASCII))
    assert is_tetrahedron(read(file, ASCII.replace("\n", "\r\n")))


@pytest.mark.parametrize(("encoding", "order"), [("binary_little_endian", "<"), ("binary_big_endian", ">")])
def test_both_byte_orders_with_columns_and_elements_nobody_asked_for(file: Path, encoding: str, order: str) -> None:
    header = (
        f"ply\nformat {encoding} 1.0\nelement edge 1\nproperty list uchar short ends\nelement vertex 4\n"
        "property uchar red\nproperty double z\nproperty double y\nproperty double x\n"
        "element face 4\nproperty list uint8 uint vertex_index\nproperty list ushort float uv\nproperty char flag\nend_header\n"
    )
    body = struct.pack(order + "Bhh", 2, 1, 2)
    body += b"".join(struct.pack(order + "Bddd", 9, z, y, x) for x, y, z in CORNERS_MM)
    body += b"".join(struct.pack(order + "BIIIHffb", 3, *face, 2, 0.5, 0.5, -1) for face in TRIANGLES)
    assert is_tetrahedron(read(file, header.encode() + body))


def test_polygons_become_fans_and_are_told(file: Path) -> None:
    header = HEADER.format("{}").replace("vertex 4", "vertex 5") + FACES.replace("face 4", "face 3")
    rows = [[0, 1, 2], [0, 1, 2, 3, 4], [4, 3, 2, 1]]
    points = [[0, 0, 0], [1, 0, 0], [2, 1, 0], [1, 2, 0], [0, 1, 0]]
    text = "\n".join(" ".join(map(str, row)) for row in [*points, *([len(row), *row] for row in rows)])
    binary = np.array(points, "<f4").tobytes() + b"".join(struct.pack(f"<B{len(row)}i", len(row), *row) for row in rows)
    for content in (header.format("ascii").encode() + text.encode(), header.format("binary_little_endian").encode() + binary):
        reading = read(file, content)
        assert reading.pieces[0].faces.tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3], [0, 3, 4], [4, 3, 2], [4, 2, 1]]
        assert [(finding.code, finding.count) for finding in reading.findings] == [("mesh.polygons_split", 2)]


def test_writing_keeps_every_bit_and_is_deterministic(file: Path) -> None:
    ply.write(jagged(), file, "skin\nend_header\n")
    first = file.read_bytes()
    (piece,) = ply.read(file).pieces
    assert piece.vertices.tobytes() == jagged().vertices.tobytes()
    assert np.array_equal(piece.faces, TRIANGLES)
    ply.write(jagged(), file, "skin\nend_header\n")
    assert file.read_bytes() == first


@pytest.mark.parametrize(
    ("content", "code", "words"),
    [
        (ASCII[:60], "ply.truncated", "no 'end_header' line in the first 60 bytes"),
        (ASCII[:-9], "ply.truncated", "'face': 4 rows declared, 3 found"),
        (ASCII.split("3 0 2 1")[0], "ply.truncated", "'face': 4 rows declared, 0 found"),
        (ASCII.split("0 0 100")[0], "ply.truncated", "'vertex': 4 rows declared, 3 found"),
        (ASCII.replace("vertex 4", "vertex 4294967295"), "ply.truncated", "'vertex': 4294967295 rows declared"),
        (ASCII + "1 2 3", "ply.malformed", "24 bytes follow the last element"),
        (ASCII.replace("format ascii 1.0\n", ""), "ply.malformed", "no line 'format"),
        (ASCII.replace("ascii 1.0", "ascii 2.0"), "ply.malformed", "header line 2 is not understood: 'format ascii 2.0'"),
        (ASCII.replace("float y", "quad y"), "ply.malformed", "header line 6"),
        (ASCII.replace("list uchar", "list float"), "ply.malformed", "header line 9"),
        (ASCII.replace("float y", "float x"), "ply.malformed", "'vertex' has 3 properties with 2 different names"),
        (ASCII.replace("float z", "float depth"), "ply.malformed", "numbers x, y and z"),
        (ASCII.replace("vertex_indices", "corners"), "ply.malformed", "a list 'vertex_indices'"),
        (ASCII.replace("3 0 2 1", "2 0 2"), "ply.malformed", "face 0 (from 0) has 2 corners"),
        (ASCII.replace("3 0 2 1", "-3 0 2 1"), "ply.malformed", "a list of -3 entries"),
        (ASCII.replace("3 0 2 1", "nan 0 2 1"), "ply.malformed", "a list of nan entries"),
        (ASCII.replace("3 0 2 1", "1e9 0 2 1"), "ply.malformed", "a list of 1e+09 entries"),
        (ASCII.replace("3 0 2 1", "3 0 2 1.5"), "ply.malformed", "1 face indices are not whole numbers, the first is 1.5"),
        (ASCII.replace("3 0 2 1", "3 0 2 inf"), "ply.malformed", "the first is inf"),
        (ASCII.replace("3 0 2 1", "3 0 2 4"), "mesh.index_out_of_range", "indices run from 0 to 4, 4 vertices allow 0 to 3"),
        (ASCII.replace("3 0 2 1", "3 0 2 -1"), "mesh.index_out_of_range", "run from -1 to 3"),
        (ASCII.replace("100", "a hundred"), "ply.malformed", "no number"),
        (ASCII.replace("100", "1_00"), "ply.malformed", "no numbers"),
        (ASCII.replace("face 4", "face 0").split("3 0 2")[0], "mesh.empty", "4 vertices and 0 faces"),
    ],
)
def test_what_is_no_ply_is_refused_with_numbers(file: Path, content: str, code: str, words: str) -> None:
    with pytest.raises(InputError) as caught:
        read(file, content)
    assert (caught.value.code, words in caught.value.message) == (code, True), caught.value.message


def test_a_binary_body_is_never_trusted(file: Path) -> None:
    header = (HEADER.format("binary_little_endian") + FACES.replace("uchar", "uint")).encode()
    points = np.array(CORNERS_MM, "<f4").tobytes()
    rows = b"".join(struct.pack("<I3i", 3, *face) for face in TRIANGLES)
    assert is_tetrahedron(read(file, header + points + rows))
    for body, code in (
        (points + rows[:-1], "ply.truncated"),
        (points + rows + b"\0", "ply.malformed"),
        (points + struct.pack("<I", 0xFFFFFFFF) + rows[4:], "ply.malformed"),
        (points + struct.pack("<I", 99_999) + rows[4:], "ply.truncated"),
        (points + rows[:16] + struct.pack("<I", 99_999) + rows[20:], "ply.truncated"),
    ):
        with pytest.raises(InputError) as caught:
            read(file, header + body)
        assert caught.value.code == code, body
