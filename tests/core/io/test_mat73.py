from __future__ import annotations

import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from core.errors import InputError, LimitError
from core.io import hdf5_chunks, mat, mat73
from tests.core.io.tiny import CORNERS_MM, TRIANGLES

P = np.array(CORNERS_MM)
T = np.array(TRIANGLES) + 1.0
MATLAB_HEADER = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "upload"


def put(group: h5py.Group, name: str, array: np.ndarray, matlab_class: str = "double", **options: Any) -> h5py.Dataset:
    """A matrix as MATLAB lays it out: transposed, with its class beside it."""
    dataset = group.create_dataset(name, data=array.T, **options)
    dataset.attrs["MATLAB_class"] = np.bytes_(matlab_class)
    return dataset


def write(file: Path, fill: Callable[[h5py.File], None], *, with_mesh: bool = True, **options: Any) -> None:
    with h5py.File(file, "w", userblock_size=512, **options) as content:
        if with_mesh:
            put(content, "P", P)
            put(content, "t", T)
        fill(content)
    with file.open("r+b") as stream:
        stream.write(MATLAB_HEADER)


def is_tetrahedron(file: Path) -> bool:
    (piece,) = mat.read(file).pieces
    return np.array_equal(piece.vertices, P) and np.array_equal(piece.faces, TRIANGLES)


@pytest.mark.parametrize("libver", ["earliest", "latest"])
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"chunks": (3, 4)},
        {"compression": "gzip", "chunks": (2, 3)},
        {"compression": "gzip", "shuffle": True, "fletcher32": True, "chunks": (1, 3)},
        {"fletcher32": True, "chunks": (3, 3)},
        {"maxshape": (None, None), "chunks": (2, 2), "shuffle": True, "compression": "gzip"},
    ],
)
@pytest.mark.parametrize(("kind", "matlab_class"), [("<f8", "double"), (">f4", "single"), ("<i2", "int16"), ("u1", "uint8")])
def test_every_storage_matlab_and_h5py_use_is_read(
    file: Path, libver: str, options: dict[str, Any], kind: str, matlab_class: str
) -> None:
    def fill(content: h5py.File) -> None:
        put(content, "P", P.astype(kind), matlab_class, **options)
        put(content, "t", T.astype(kind), matlab_class, **options)
        content.create_group("#refs#")
        content.create_group("options").attrs["MATLAB_class"] = np.bytes_("struct")

    write(file, fill, with_mesh=False, libver=libver)
    assert is_tetrahedron(file)


def test_plain_hdf5_without_matlabs_marks_is_read(file: Path) -> None:
    with h5py.File(file, "w") as content:
        content["Vertices"] = P.T
        content["Faces"] = T.T
    assert is_tetrahedron(file)


def test_many_chunks_agree_with_hdf5(file: Path) -> None:
    array = np.random.default_rng(1).normal(size=(3, 1001))
    with h5py.File(file, "w") as content:
        dataset = content.create_dataset("P", data=array, chunks=(2, 64), compression="gzip", shuffle=True, fletcher32=True)
        assert np.array_equal(hdf5_chunks.read_chunks(dataset.id, content.id.get_filesize()), array)


@pytest.mark.parametrize("data", [b"", b"\0", b"abc", bytes(range(256)) * 999, b"\xff" * 70001])
def test_fletcher32_is_that_of_hdf5(file: Path, data: bytes) -> None:
    content_bytes = data or b"\0\0"
    with h5py.File(file, "w") as content:
        array = np.frombuffer(content_bytes, np.uint8)
        dataset = content.create_dataset("x", data=array, chunks=array.shape, fletcher32=True)
        _, stored = dataset.id.read_direct_chunk((0,))
    hdf5_chunks.undo_filters(stored, [(h5py.h5z.FILTER_FLETCHER32, ())], 0, len(content_bytes), 1)
    damaged = stored[:-1] + bytes([stored[-1] ^ 1])
    with pytest.raises(InputError, match="was stored"):
        hdf5_chunks.undo_filters(damaged, [(h5py.h5z.FILTER_FLETCHER32, ())], 0, len(content_bytes), 1)


def test_links_out_of_the_file_are_refused(file: Path, tmp_path: Path) -> None:
    other = tmp_path / "secret.h5"
    with h5py.File(other, "w") as content:
        content["P"] = P.T

    def external(content: h5py.File) -> None:
        content["P"] = h5py.ExternalLink(str(other), "/P")

    def soft(content: h5py.File) -> None:
        content["hidden/P"] = P.T
        content["P"] = h5py.SoftLink("/hidden/P")

    def beside_the_mesh(content: h5py.File) -> None:
        put(content, "P", P)
        content["z"] = h5py.ExternalLink(str(other), "/")

    for fill in (external, soft, beside_the_mesh):
        write(file, lambda content, fill=fill: (put(content, "t", T), fill(content)), with_mesh=False)  # type: ignore[misc]
        with pytest.raises(InputError, match="is a soft or external link") as caught:
            mat.read(file)
        assert caught.value.code == "hdf5.link_refused"


def test_a_mesh_behind_an_inner_link_is_not_found(file: Path, tmp_path: Path) -> None:
    def fill(content: h5py.File) -> None:
        content.create_group("g")["P"] = h5py.ExternalLink(str(tmp_path / "secret.h5"), "/P")

    write(file, fill, with_mesh=False)
    with pytest.raises(InputError) as caught:
        mat.read(file)
    assert caught.value.code == "mat.variable_missing"


def test_external_storage_is_refused(file: Path, tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_bytes(P.T.tobytes())

    def fill(content: h5py.File) -> None:
        content.create_dataset("P", P.T.shape, "<f8", external=[(str(secret), 0, P.nbytes)])
        put(content, "t", T)

    write(file, fill, with_mesh=False)
    with pytest.raises(InputError, match="P is stored in another file") as caught:
        mat.read(file)
    assert caught.value.code == "hdf5.link_refused"


def test_virtual_datasets_are_refused(file: Path, tmp_path: Path) -> None:
    other = tmp_path / "secret.h5"
    with h5py.File(other, "w") as content:
        content["P"] = P.T

    def fill(content: h5py.File) -> None:
        layout = h5py.VirtualLayout(shape=P.T.shape, dtype="<f8")
        layout[:] = h5py.VirtualSource(str(other), "P", shape=P.T.shape)
        content.create_virtual_dataset("P", layout)
        put(content, "t", T)

    write(file, fill, with_mesh=False, libver="latest")
    with pytest.raises(InputError, match="P is a virtual dataset") as caught:
        mat.read(file)
    assert caught.value.code == "hdf5.link_refused"


def test_other_filters_are_refused(file: Path) -> None:
    write(file, lambda content: (put(content, "P", P, compression="lzf"), put(content, "t", T)), with_mesh=False)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="filter 32000; allowed are gzip, shuffle, fletcher32") as caught:
        mat.read(file)
    assert caught.value.code == "hdf5.filter_refused"


@pytest.mark.parametrize("options", [{"chunks": (3, 1000), "compression": "gzip"}, {}])
def test_a_declared_29_gib_is_refused_unread(file: Path, options: dict[str, Any]) -> None:
    def fill(content: h5py.File) -> None:
        content.create_dataset("P", (3, 29 * 2**30 // 24), "<f8", **options)
        put(content, "t", T)

    write(file, fill, with_mesh=False)
    assert file.stat().st_size < 20_000
    with pytest.raises(LimitError, match=f"takes {29 * 2**30 // 24 * 24} bytes, 536870912 are allowed") as caught:
        mat.read(file)
    assert caught.value.code == "hdf5.too_large"


def test_a_huge_chunk_is_refused(file: Path) -> None:
    def fill(content: h5py.File) -> None:
        content.create_dataset("P", (3, 4), "<f8", chunks=(3, 2**25), maxshape=(3, None), compression="gzip")
        put(content, "t", T)

    write(file, fill, with_mesh=False)
    with pytest.raises(LimitError, match="a chunk of variable P takes 805306368 bytes"):
        mat.read(file)


def test_a_chunk_that_unpacks_to_more_than_it_says_is_refused(file: Path) -> None:
    def fill(content: h5py.File) -> None:
        dataset = content.create_dataset("P", (3, 4), "<f8", chunks=(3, 4), compression="gzip")
        dataset.id.write_direct_chunk((0, 0), zlib.compress(bytes(1 << 24)))
        put(content, "t", T)

    write(file, fill, with_mesh=False)
    with pytest.raises(InputError, match="more or less than its 96 bytes") as caught:
        mat.read(file)
    assert caught.value.code == "hdf5.corrupt"


def test_a_chunk_shorter_than_its_checksum_is_refused(file: Path) -> None:
    """HDF5 2.0.0 itself ends in a segmentation fault here."""

    def fill(content: h5py.File) -> None:
        dataset = content.create_dataset("P", (3, 4), "<f8", chunks=(3, 4), compression="gzip", fletcher32=True)
        dataset.id.write_direct_chunk((0, 0), b"\x01")
        put(content, "t", T)

    write(file, fill, with_mesh=False)
    with pytest.raises(InputError, match=r"was stored|cannot be unpacked|more or less") as caught:
        mat.read(file)
    assert caught.value.code == "hdf5.corrupt"


def test_chunks_never_written_are_refused(file: Path) -> None:
    def fill(content: h5py.File) -> None:
        content.create_dataset("P", (3, 4), "<f8", chunks=(3, 2))[:, :2] = 1.0
        put(content, "t", T)

    write(file, fill, with_mesh=False)
    with pytest.raises(InputError, match="has 1 chunks, 2 are needed"):
        mat.read(file)


def test_objects_functions_and_words_are_refused(file: Path) -> None:
    def function(content: h5py.File) -> None:
        content.create_group("f").attrs["MATLAB_class"] = np.bytes_("function_handle")

    def classdef(content: h5py.File) -> None:
        put(content, "o", np.zeros((1, 6), np.uint32), "string").attrs["MATLAB_object_decode"] = np.int32(3)

    def words(content: h5py.File) -> None:
        del content["P"]
        put(content, "P", np.zeros((4, 3), np.uint16), "char")

    def references(content: h5py.File) -> None:
        del content["P"]
        content.create_dataset("P", (3, 4), h5py.ref_dtype)

    def group(content: h5py.File) -> None:
        del content["P"]
        content.create_group("P")

    for fill, shown in (
        (function, "f is of class function_handle"),
        (classdef, "o is of class object"),
        (words, "P is of class char"),
    ):
        write(file, fill)
        with pytest.raises(InputError, match=shown) as caught:
            mat.read(file)
        assert caught.value.code == "mat.class_refused"
    for fill in (references, group):
        write(file, fill)
        with pytest.raises(InputError, match=r"P is of class (struct|not numeric), real numbers are needed"):
            mat.read(file)


def test_a_class_that_is_no_short_text_is_refused(file: Path) -> None:
    for value in ("x" * 100, ["double", "double"], np.bytes_("x" * 65), 5):
        write(file, lambda content, value=value: content["P"].attrs.__setitem__("MATLAB_class", value))  # type: ignore[misc]
        with pytest.raises(InputError, match="MATLAB_class is not a") as caught:
            mat.read(file)
        assert caught.value.code == "hdf5.corrupt"


def test_untransposed_arrays_are_refused(file: Path) -> None:
    with h5py.File(file, "w") as content:
        content["P"] = P
        content["t"] = T
    with pytest.raises(InputError, match="P is 3 x 4") as caught:
        mat.read(file)
    assert caught.value.code == "mat.shape"


def test_too_many_names_are_refused(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mat73, "MOST_NAMES", 5)
    write(file, lambda content: [content.create_group(f"g{number}") for number in range(4)])  # type: ignore[func-returns-value]
    with pytest.raises(LimitError, match="6 names, 5 are allowed"):
        mat.read(file)


@pytest.mark.parametrize("kept", [513, 600, 1000, -1])
def test_a_cut_file_is_refused(file: Path, kept: int) -> None:
    write(file, lambda content: None)
    file.write_bytes(file.read_bytes()[:kept])
    with pytest.raises(InputError, match="damaged or cut off") as caught:
        mat.read(file)
    assert caught.value.code == "hdf5.corrupt"


def test_vectors_with_a_number_per_vertex_come_along(file: Path) -> None:
    depths = np.array([0.3, 0.6, 1.0, 3.0])

    def fill(group: h5py.File) -> None:
        put(group, "fat_mm", depths[None, :], compression="gzip", chunks=(2, 1))
        put(group, "text", np.arange(4, dtype=np.uint16)[:, None], "char")

    write(file, fill)
    (piece,) = mat.read(file).pieces
    assert list(piece.arrays) == ["fat_mm"]
    assert np.array_equal(piece.arrays["fat_mm"], depths)
