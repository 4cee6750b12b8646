from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.io

from core.errors import InputError, LimitError
from core.io import mat, mat5
from core.io.mat5 import Mat5File
from core.io.reading import Piece
from tests.core.io import matlab_bytes as craft
from tests.core.io.tiny import CORNERS_MM, TETRAHEDRON, TRIANGLES, jagged

P = np.array(CORNERS_MM)
T = np.array(TRIANGLES) + 1.0
OUTWARD = np.array([[0.0, 0, -1], [0, -1, 0], [1, 1, 1], [-1, 0, 0]])
GOOD = (craft.matrix("P", P), craft.matrix("t", T))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "upload"


def read_bytes(file: Path, content: bytes) -> Piece:
    file.write_bytes(content)
    (piece,) = mat.read(file).pieces
    return piece


def is_tetrahedron(piece: Piece) -> bool:
    return np.array_equal(piece.vertices, P) and np.array_equal(piece.faces, TRIANGLES)


@pytest.mark.parametrize("do_compression", [False, True])
@pytest.mark.parametrize(
    "arrays",
    [
        {"P": P, "t": T},
        {"p": P, "T": T},
        {"Vertices": P.astype(np.float32), "FACES": T.astype(np.uint16)},
        {"P": P.astype(np.int64), "t": T.astype(np.int8)},
        {
            "note": "a word",
            "extra": {"field": 1.0},
            "cells": np.array([1, "two"], dtype=object),
            "P": P,
            "t": T,
            "x": np.zeros((9, 9)),
        },
        {"P": P, "p": P * 2, "t": T},
    ],
)
def test_what_scipy_writes_is_read(file: Path, arrays: dict[str, Any], do_compression: bool) -> None:
    scipy.io.savemat(file, arrays, appendmat=False, do_compression=do_compression)
    assert is_tetrahedron(mat.read(file).pieces[0])


@pytest.mark.parametrize("order", ["<", ">"])
def test_both_byte_orders_are_read(file: Path, order: str) -> None:
    content = craft.mat_file(craft.matrix("P", P, order=order), craft.matrix("t", T, order=order), order=order)
    assert is_tetrahedron(read_bytes(file, content))


def test_what_is_written_scipy_reads(file: Path) -> None:
    mat.write(jagged(), file, "skin")
    held = scipy.io.loadmat(file)
    assert {name: held[name].dtype for name in ("P", "t", "normals")} == dict.fromkeys(("P", "t", "normals"), np.dtype(float))
    assert held["P"].tobytes() == np.asfortranarray(jagged().vertices).tobytes() or np.array_equal(held["P"], jagged().vertices)
    assert np.array_equal(held["t"], T)


def test_written_normals_point_outward_and_bytes_are_deterministic(file: Path) -> None:
    mat.write(TETRAHEDRON, file, "skin")
    first = file.read_bytes()
    normals = scipy.io.loadmat(file)["normals"]
    assert np.allclose(normals, OUTWARD / np.linalg.norm(OUTWARD, axis=1)[:, None])
    mat.write(TETRAHEDRON, file, "skin")
    assert file.read_bytes() == first
    assert first.startswith(b"MATLAB 5.0 MAT-file, written by Integument, millimetres   ")


@pytest.mark.parametrize(
    ("normals", "expected"),
    [(OUTWARD, []), (-OUTWARD, [("mat.normals_disagree", 4)]), (OUTWARD[:3], [("mat.normals_ignored", 3)])],
)
def test_normals_are_compared_with_the_winding(file: Path, normals: np.ndarray, expected: list[tuple[str, int]]) -> None:
    file.write_bytes(craft.mat_file(*GOOD, craft.matrix("normals", normals)))
    reading = mat.read(file)
    assert is_tetrahedron(reading.pieces[0])
    assert [(finding.code, finding.count) for finding in reading.findings] == expected


@pytest.mark.parametrize(
    ("content", "code", "words"),
    [
        (craft.mat_file(), "mat.variable_missing", "no variable P or vertices among the 0"),
        (
            craft.mat_file(craft.matrix("P", P)),
            "mat.variable_missing",
            "no variable t or faces among the 1 of the file, which has P (4, 3)",
        ),
        (
            craft.mat_file(GOOD[0], craft.matrix("t", T - 1)),
            "mat.zero_based",
            "3 entries of t are 0, the largest is 3 for 4 vertices",
        ),
        (
            craft.mat_file(GOOD[0], craft.matrix("t", T + 1)),
            "mesh.index_out_of_range",
            "run from 2 to 5, 4 vertices allow 1 to 4",
        ),
        (craft.mat_file(GOOD[0], craft.matrix("t", T - 9)), "mesh.index_out_of_range", "run from -8 to -5"),
        (
            craft.mat_file(GOOD[0], craft.matrix("t", T + 0.5)),
            "mat.index_not_whole",
            "12 entries of t are no whole numbers, the first is 1.5",
        ),
        (craft.mat_file(GOOD[0], craft.matrix("t", T * np.nan)), "mat.index_not_whole", "the first is nan"),
        (craft.mat_file(GOOD[0], craft.matrix("t", T * 1e300)), "mat.index_not_whole", "the first is 1e+300"),
        (craft.mat_file(craft.matrix("P", P.T), GOOD[1]), "mat.shape", "P is 3 x 4"),
        (craft.mat_file(craft.matrix("P", P, shape=(4, 3, 1)), GOOD[1]), "mat.shape", "P is 4 x 3 x 1"),
        (craft.mat_file(GOOD[0], craft.matrix("t", np.ones((2, 4)))), "mat.shape", "t is 2 x 4"),
        (craft.mat_file(craft.matrix("P", np.empty((0, 3))), GOOD[1]), "mesh.empty", "0 vertices and 4 faces"),
        (craft.mat_file(*GOOD, craft.matrix("p", P), craft.matrix("P", P)), "mat.variable_ambiguous", "P: P, P"),
        (craft.mat_file(craft.matrix("vertices", P), craft.matrix("VERTICES", P)), "mat.variable_missing", "t or faces"),
        (
            craft.mat_file(craft.matrix("Vertices", P), craft.matrix("VERTICES", P), GOOD[1]),
            "mat.variable_ambiguous",
            "VERTICES, Vertices",
        ),
        (craft.mat_file(*GOOD, craft.function_handle("f")), "mat.class_refused", "variable f is of class function_handle"),
        (craft.mat_file(*GOOD, craft.opaque_object("s")), "mat.class_refused", "variable s is of class opaque"),
        (craft.mat_file(craft.compressed(craft.opaque_object("s")), *GOOD), "mat.class_refused", "variable s is of class opaque"),
        (craft.mat_file(*GOOD, craft.matrix("o", P, flags=craft.OBJECT)), "mat.class_refused", "variable o is of class object"),
        (craft.mat_file(craft.function_handle("P"), GOOD[1]), "mat.class_refused", "variable P is of class function_handle"),
        (craft.mat_file(craft.matrix("P", P, flags=craft.CHAR), GOOD[1]), "mat.class_refused", "variable P is of class char"),
        (craft.mat_file(craft.matrix("P", P, flags=craft.DOUBLE | 0x0800), GOOD[1]), "mat.class_refused", "complex double"),
        (craft.mat_file(GOOD[0], craft.matrix("t", T, flags=craft.DOUBLE | 0x0200)), "mat.class_refused", "class logical"),
    ],
)
def test_what_is_no_mesh_is_refused_with_numbers(file: Path, content: bytes, code: str, words: str) -> None:
    file.write_bytes(content)
    with pytest.raises(InputError) as caught:
        mat.read(file)
    assert (caught.value.code, words in caught.value.message) == (code, True), caught.value.message


def test_cells_sparse_and_structs_are_no_vertices(file: Path) -> None:
    for content in (np.array([1, "two", 3], dtype=object), scipy.sparse.eye_array(3).tocsc(), {"x": 1.0}):
        scipy.io.savemat(file, {"P": content, "t": T}, appendmat=False)
        with pytest.raises(InputError, match=r"variable P is of class (cell|sparse|struct)"):
            mat.read(file)


def test_real_files_of_matlab_with_functions_and_objects_are_refused(file: Path) -> None:
    folder = Path(scipy.io.matlab.__file__).parent / "tests" / "data"
    for name in ("testfunc_7.4_GLNX86.mat", "testobject_7.4_GLNX86.mat", "testobject_6.1_SOL2.mat"):
        with pytest.raises(InputError) as caught:
            mat.read(folder / name)
        assert caught.value.code == "mat.class_refused", name


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"MATLAB 5.0 MAT-file", "19 bytes"),
        (bytes(200), "no MAT file of version 5 to 7.3"),
        (craft.mat_file(*GOOD)[:-9], "the file at"),
        (craft.mat_file(*GOOD)[: -len(GOOD[1]) + 3], "3 bytes are left"),
        (craft.mat_file(craft.element(9, bytes(8))), "has type 9"),
        (craft.mat_file(craft.matrix("P", P, shape=(5, 3)), GOOD[1]), "shape (5, 3) has 96 bytes"),
        (craft.mat_file(craft.matrix("P", P, shape=(-4, 3)), GOOD[1]), "dimensions (-4, 3)"),
        (craft.mat_file(craft.matrix("P", P, flags=99), GOOD[1]), "class 99"),
        (craft.mat_file(craft.element(craft.MATRIX, b"")), "0 bytes ends before"),
        (craft.mat_file(craft.compressed(GOOD[0])[:-5] + bytes(5), GOOD[1]), "cannot be unpacked"),
        (craft.mat_file(craft.compressed(GOOD[0][:-8]), GOOD[1]), "does not unpack to"),
        (craft.mat_file(craft.compressed(GOOD[0] + b"more"), GOOD[1]), "does not unpack to"),
        (craft.mat_file(craft.compressed(craft.element(9, bytes(8)))), "holds type 9"),
    ],
)
def test_damaged_files_are_refused(file: Path, content: bytes, words: str) -> None:
    file.write_bytes(content)
    with pytest.raises(InputError) as caught:
        mat.read(file)
    assert (caught.value.code, words in caught.value.message) == ("mat.corrupt", True), caught.value.message


def test_a_matrix_larger_than_allowed_is_refused_unread(file: Path) -> None:
    file.write_bytes(craft.mat_file(craft.compressed(craft.matrix("P", P, shape=(1 << 30, 3))), GOOD[1]))
    with pytest.raises(LimitError, match="25769803776 bytes, 536870912 are allowed") as caught:
        mat.read(file)
    assert caught.value.code == "mat.too_large"


def test_a_bomb_is_not_unpacked_further_than_its_shape_allows() -> None:
    bomb = craft.compressed(craft.element(craft.MATRIX, craft.head("P", (4, 3), craft.DOUBLE) + craft.element(9, bytes(1 << 24))))
    file = Mat5File(craft.mat_file(bomb))
    with pytest.raises(InputError, match="declares 16777272 bytes, 4192 at most fit"):
        file.load(file.variables[0])


def test_variables_nobody_asked_for_are_not_unpacked(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    unpacked: list[str] = []
    load = Mat5File.load

    def note(self: Mat5File, variable: mat5.MatVariable) -> np.ndarray:
        unpacked.append(variable.name)
        return load(self, variable)

    monkeypatch.setattr(Mat5File, "load", note)
    assert is_tetrahedron(read_bytes(file, craft.mat_file(craft.matrix("big", P), *GOOD, craft.matrix("more", P))))
    assert unpacked == ["P", "t"]


def test_too_many_variables_are_refused(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mat5, "MOST_VARIABLES", 3)
    file.write_bytes(craft.mat_file(*(craft.matrix(f"v{number}", P) for number in range(4))))
    with pytest.raises(InputError, match="more than 3 variables"):
        mat.read(file)


@pytest.mark.parametrize("do_compression", [False, True])
def test_vectors_with_a_number_per_vertex_come_along(file: Path, do_compression: bool) -> None:
    depths = np.array([0.3, 0.6, 1.0, 3.0])
    others = {
        "fat_mm": depths[:, None],
        "row": depths.astype(np.float32)[None, :],
        "wide": np.ones((4, 2)),
        "complex": depths * 1j,
    }
    scipy.io.savemat(file, {"P": P, "t": T, **others}, appendmat=False, do_compression=do_compression)
    (piece,) = mat.read(file).pieces
    assert is_tetrahedron(piece)
    assert sorted(piece.arrays) == ["fat_mm", "row"]
    assert np.array_equal(piece.arrays["fat_mm"], depths)
    assert np.array_equal(piece.arrays["row"], depths.astype(np.float32))


def test_vectors_follow_their_vertices_when_some_belong_to_no_face(file: Path) -> None:
    corners = np.vstack((P[:2], [[9.0, 9.0, 9.0]], P[2:]))
    faces = np.where(T > 2, T + 1, T)
    scipy.io.savemat(file, {"P": corners, "t": faces, "fat_mm": [1.0, 2.0, 99.0, 3.0, 4.0]}, appendmat=False)
    (piece,) = mat.read(file).pieces
    assert is_tetrahedron(piece)
    assert np.array_equal(piece.arrays["fat_mm"], [1.0, 2.0, 3.0, 4.0])


def test_vectors_of_another_length_or_beyond_number_are_told(file: Path) -> None:
    many = {f"v{number:02}": np.ones(4) for number in range(18)}
    scipy.io.savemat(file, {"P": P, "t": T, "long_mm": np.ones(5), "long": np.ones(5), **many}, appendmat=False)
    reading = mat.read(file)
    assert sorted(reading.pieces[0].arrays) == sorted(many)[:16]
    (finding,) = reading.findings
    assert (finding.code, finding.count) == ("mat.array_ignored", 3)
    assert "long_mm has 5 numbers for 4 vertices; v16 is one of more than 16" in finding.message


def test_vectors_together_have_a_limit(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scipy.io.savemat(file, {"P": P, "t": T, "a": np.ones(4), "b": np.ones(4)}, appendmat=False)
    monkeypatch.setattr("core.io.mat_arrays.LARGEST_ARRAY_BYTES", 63)
    with pytest.raises(LimitError) as refused:
        mat.read(file)
    assert (refused.value.code, refused.value.facts["bytes"]) == ("mat.too_large", 64)
