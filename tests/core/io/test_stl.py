from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from core.errors import InputError
from core.io import stl, stl_binary
from subjects.body import body
from tests.core.io.stl_bytes import binary_stl, facet
from tests.core.io.tiny import CORNERS_MM, TETRAHEDRON, TRIANGLES, jagged


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "upload"


def test_a_binary_file_is_welded(file: Path) -> None:
    file.write_bytes(binary_stl())
    (piece,) = stl.read(file).pieces
    assert piece.vertices.shape == (4, 3)
    assert np.array_equal(piece.vertices[piece.faces], TETRAHEDRON.triangles())


def test_a_binary_file_may_begin_with_solid(file: Path) -> None:
    file.write_bytes(binary_stl(header=b"solid this is binary all the same"))
    assert len(stl.read(file).pieces[0].faces) == 4


def test_zeros_after_the_last_facet_are_told(file: Path) -> None:
    file.write_bytes(binary_stl(tail=bytes(512)))
    reading = stl.read(file)
    assert len(reading.pieces[0].faces) == 4
    assert [(finding.code, finding.count) for finding in reading.findings] == [("stl.trailing_zeros", 512)]


@pytest.mark.parametrize(
    ("content", "code", "numbers"),
    [
        (binary_stl(count=5), "stl.count_mismatch", ["5 facets", "334 bytes", "284 bytes", "hold 4"]),
        (binary_stl(count=3), "stl.count_mismatch", ["3 facets", "284 bytes", "hold 4"]),
        (binary_stl(count=0xFFFFFFFF), "stl.count_mismatch", ["4294967295 facets", "hold 4"]),
        (binary_stl(tail=bytes(49) + b"\1"), "stl.count_mismatch", ["4 facets", "hold 5"]),
        (binary_stl()[:-1], "stl.truncated", ["4 facets", "283 bytes", "inside facet 3"]),
        (binary_stl()[:90], "stl.truncated", ["90 bytes", "inside facet 0"]),
        (b"exported by a program".ljust(80) + binary_stl()[80:84], "stl.count_mismatch", ["84 bytes"]),
        (bytes(60), "stl.truncated", ["60 bytes", "84"]),
        (bytes(84), "mesh.empty", ["0 facets"]),
        (bytes(84) + facet(CORNERS_MM[:3]), "stl.count_mismatch", ["0 facets", "hold 1"]),
        (b"Dear colleague, please find the mesh attached.\n" * 9, "stl.not_stl", ["423 bytes"]),
        (b"solid as a rock is the argument that follows.\n" * 9, "stl.not_stl", ["as a rock"]),
        (b"solid\0" + binary_stl(count=9)[6:], "stl.count_mismatch", ["9 facets"]),
        (b"solid a\nendsolid a\n", "mesh.empty", ["1 solids"]),
    ],
)
def test_what_is_no_stl_is_refused_with_numbers(file: Path, content: bytes, code: str, numbers: list[str]) -> None:
    file.write_bytes(content)
    with pytest.raises(InputError) as caught:
        stl.read(file)
    assert caught.value.code == code
    assert [number for number in numbers if number not in caught.value.message] == []


def test_every_float32_bit_survives(file: Path) -> None:
    rng = np.random.default_rng(3)
    mesh = TETRAHEDRON.with_vertices(rng.normal(scale=1e3, size=(4, 3)).astype(np.float32))
    stl_binary.write(mesh, file, "bits")
    (piece,) = stl.read(file).pieces
    assert piece.vertices[piece.faces].tobytes() == mesh.triangles().astype(np.float32).tobytes()


def test_writing_is_deterministic_and_never_begins_with_solid(file: Path) -> None:
    stl_binary.write(jagged(), file, "solid name\n\0with " + "x" * 200)
    first = file.read_bytes()
    stl_binary.write(jagged(), file, "solid name\n\0with " + "x" * 200)
    assert file.read_bytes() == first
    assert not first.startswith(b"solid")
    assert len(first) == 84 + 50 * 4


def test_written_normals_point_outward_and_are_zero_without_area(file: Path) -> None:
    flat = TETRAHEDRON.with_vertices([CORNERS_MM[0], CORNERS_MM[1], CORNERS_MM[1], CORNERS_MM[3]])
    stl_binary.write(flat, file, "flat")
    normals = [struct.unpack_from("<3f", file.read_bytes(), 84 + 50 * face) for face in range(len(TRIANGLES))]
    assert normals[0] == (0.0, 0.0, 0.0)
    assert normals[1] == (0.0, -1.0, 0.0)


def test_the_body_comes_back_whole(file: Path) -> None:
    mesh = body(0)
    stl_binary.write(mesh, file, "body")
    (piece,) = stl.read(file).pieces
    assert len(piece.vertices) == len(mesh.vertices)
    assert np.array_equal(piece.vertices[piece.faces], mesh.triangles())
