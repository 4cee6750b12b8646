"""Files that are well-formed but lie: sizes, counts, types, offsets and names chosen by hand-made rules of each format."""

from __future__ import annotations

import math
import struct
import zipfile
import zlib
from io import BytesIO

import h5py
import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.core.io import matlab_bytes as craft
from tests.core.io import mgh_bytes
from tests.core.io.mgh_bytes import mgh
from tests.core.io.nifti_bytes import CODES, nifti, packed, two_boxes
from tests.core.io.stl_bytes import binary_stl
from tests.core.io.tiny import TETRAHEDRON
from tests.fuzz.readers import read_labels, read_upload, read_zip

P, T = TETRAHEDRON.vertices, TETRAHEDRON.faces + 1.0
STL_LINES = (
    *("solid s", "facet normal 0 0 1", "outer loop", "vertex 0 0 1e400", "vertex 1 2 3", "vertex nan 0 0", "vertex 1"),
    *("endloop", "endfacet", "endsolid s", "endsolid", "", "\0", "é", "vertex " + "9" * 400 + " 0 0"),
)
OBJ_LINES = (
    *("v 0 0 0", "v 1 0 0", "v 0 1 0", "v nan 0 0", "v 1e999 0 0", "v 1", "f 1 2 3", "f -1 -2 -3", "f 0 1 2"),
    *("f 99999999999999999999 1 2", "f 1//1 2//2 3//3", "f " + "1 " * 500, "o ../../etc", "usemtl x", "\\", "#"),
)
BRIEF = settings(max_examples=120, derandomize=True, deadline=None, suppress_health_check=list(HealthCheck))

lies = st.sampled_from([0, 1, 2, 3, 4, 5, 7, 255, 2**15, 2**31 - 1, 2**31, 2**32 - 1])
signed = st.sampled_from([-(2**31), -1, 0, 1, 3, 4, 12, 2**16, 2**31 - 1])
words = st.sampled_from(["P", "t", "p", "T", "vertices", "faces", "normals", "", "P\0", "../P", "\u202eP", "P" * 63, "ä"])
numbers = st.floats(width=64) | st.sampled_from([math.nan, math.inf, -math.inf, 1e308, -1e308, 5e-324, 1e39, 0.0])


@BRIEF
@given(count=lies, tail=st.binary(max_size=60), header=st.binary(max_size=80), corner=numbers)
def test_stl(count: int, tail: bytes, header: bytes, corner: float) -> None:
    with np.errstate(all="ignore"):
        mesh = TETRAHEDRON.with_vertices(P) if not math.isfinite(corner) else TETRAHEDRON
        data = bytearray(binary_stl(mesh, header=header[:80], count=count % 2**32, tail=tail))
        data[96:100] = struct.pack("<f", np.float32(corner))
    read_upload(bytes(data), "stl")


@BRIEF
@given(st.lists(st.sampled_from(STL_LINES), max_size=40))
def test_stl_in_words(lines: list[str]) -> None:
    read_upload("\n".join(["solid s", *lines]).encode(), "stl")


@BRIEF
@given(
    name=words,
    other=words,
    shape=st.lists(signed, max_size=5).map(tuple),
    flags=st.integers(0, 2**16),
    kind=st.integers(0, 20),
    stated=lies,
    packed=st.booleans(),
    order=st.sampled_from("<>"),
)
def test_mat5(
    name: str, other: str, shape: tuple[int, ...], flags: int, kind: int, stated: int, packed: bool, order: str
) -> None:
    honest = craft.matrix("t", T, order=order)
    lying = craft.element(14, craft.head(name, shape, flags, order) + struct.pack(order + "II", kind, stated) + bytes(64), order)
    elements = [lying, craft.matrix(other, P, order=order), honest]
    if packed and order == "<":
        elements = [craft.compressed(element) for element in elements]
    read_upload(craft.mat_file(*elements, order=order), "mat")


@BRIEF
@given(depth=st.integers(1, 4), size=st.integers(0, 1 << 16), shape=st.tuples(signed, signed))
def test_mat5_packed_in_itself(depth: int, size: int, shape: tuple[int, int]) -> None:
    element = craft.element(14, craft.head("P", shape, craft.DOUBLE) + craft.element(9, bytes(size)))
    for _ in range(depth):
        element = struct.pack("<II", 15, 0) + zlib.compress(element, 1)
        element = struct.pack("<II", 15, len(element) - 8) + element[8:]
    read_upload(craft.mat_file(element, craft.matrix("t", T)), "mat")


@BRIEF
@given(
    name=words.filter(lambda word: word and "\0" not in word),
    kind=st.sampled_from(["f8", "f4", "i8", "u1", "S5", "c16", "b1", "V8", "O"]),
    shape=st.lists(st.integers(0, 5), max_size=4).map(tuple),
    matlab_class=st.sampled_from([None, b"double", b"cell", b"function_handle", b"x" * 300, 5, np.zeros(3)]),
    chunks=st.booleans(),
    linked=st.sampled_from(["", "soft", "hard", "group", "reference"]),
)
def test_hdf5(name: str, kind: str, shape: tuple[int, ...], matlab_class: object, chunks: bool, linked: str) -> None:
    stream = BytesIO()
    with h5py.File(stream, "w") as content:
        content.create_dataset("t", data=T.T)
        if kind == "O":
            made = content.create_dataset(name if name != "t" else "P", shape, dtype=h5py.special_dtype(vlen=str))
        else:
            options = {"chunks": True} if chunks and shape and 0 not in shape else {}
            made = content.create_dataset(name if name != "t" else "P", data=np.zeros(shape, kind), **options)
        if matlab_class is not None:
            made.attrs["MATLAB_class"] = matlab_class
        if linked == "soft":
            content["P2"] = h5py.SoftLink("/t/../t")
        elif linked == "hard":
            content["vertices"] = content["t"]
        elif linked == "group":
            content.create_group("a/b/c")["P"] = content["t"]
        elif linked == "reference":
            content.create_dataset("#refs#", data=content["t"].ref, dtype=h5py.ref_dtype)
    read_upload(stream.getvalue(), "mat")


@BRIEF
@given(
    form=st.sampled_from(["ascii", "binary_little_endian", "binary_big_endian", "binary", "utf-8"]),
    vertices=lies,
    faces=lies,
    types=st.lists(st.sampled_from(["float", "double", "uchar", "int", "int8", "float128", "list"]), min_size=1, max_size=5),
    rows=st.binary(max_size=200),
)
def test_ply(form: str, vertices: int, faces: int, types: list[str], rows: bytes) -> None:
    head = [f"ply\nformat {form} 1.0", f"element vertex {vertices}"]
    head += [f"property {kind} {'xyzab'[place]}" for place, kind in enumerate(types)]
    head += [f"element face {faces}", "property list uchar int vertex_indices", "end_header\n"]
    read_upload("\n".join(head).encode() + rows, "ply")


@BRIEF
@given(
    kind=st.sampled_from(sorted(CODES)),
    version=st.sampled_from([1, 2]),
    order=st.sampled_from("<>"),
    dim=st.lists(st.sampled_from([-1, 0, 1, 2, 3, 5, 6, 7, 255, 32767]), min_size=1, max_size=8).map(tuple) | st.none(),
    datatype=st.none() | st.sampled_from([0, 1, 2, 16, 32, 128, 1280, 1536, 2048]),
    scale=st.tuples(numbers, numbers),
    units=st.integers(0, 255),
    offset=st.none() | st.sampled_from([0, 352, 544, 1 << 20, 2**31 - 1]),
    place=st.lists(numbers, min_size=6, max_size=6).map(tuple) | st.none(),
    sides=st.lists(numbers, min_size=4, max_size=4).map(tuple),
    pack=st.booleans(),
    cut=st.integers(0, 60),
)
def test_nifti(
    kind: str,
    version: int,
    order: str,
    dim: tuple[int, ...] | None,
    datatype: int | None,
    scale: tuple[float, float],
    units: int,
    offset: int | None,
    place: tuple[float, ...] | None,
    sides: tuple[float, ...],
    pack: bool,
    cut: int,
) -> None:
    with np.errstate(all="ignore"):
        slope, intercept, *places = (float(np.float32(number)) for number in (*scale, *(place or ()), *sides))
        data = nifti(
            two_boxes().astype(kind),
            None if place else np.diag([*places[-3:], 1.0]),
            version=version,
            order=order,
            dim=dim,
            datatype=datatype,
            slope=slope,
            intercept=intercept,
            units=units,
            offset=offset,
            quaternion=tuple(places[:6]) if place else None,
            pixdim=tuple(places[-4:]),
        )
        data = data[: len(data) - cut]
        read_labels(packed(data) if pack else data, "labels.nii.gz")


@BRIEF
@given(
    kind=st.sampled_from(sorted(mgh_bytes.CODES)),
    version=st.sampled_from([1, 2, 0x201, -1]),
    shape=st.none() | st.tuples(*[st.sampled_from([-1, 0, 1, 2, 5, 6, 7, 255, 32767, 2**31 - 1])] * 3),
    frames=st.sampled_from([1, 0, 2, -5]),
    code=st.none() | st.integers(-1, 12),
    placed=st.integers(-1, 2),
    sides=st.tuples(numbers, numbers, numbers),
    axes=st.lists(numbers, min_size=9, max_size=9).map(tuple) | st.just(mgh_bytes.CORONAL),
    middle=st.tuples(numbers, numbers, numbers),
    pack=st.booleans(),
    cut=st.integers(0, 60),
)
def test_mgh(
    kind: str,
    version: int,
    shape: tuple[int, int, int] | None,
    frames: int,
    code: int | None,
    placed: int,
    sides: tuple[float, ...],
    axes: tuple[float, ...],
    middle: tuple[float, ...],
    pack: bool,
    cut: int,
) -> None:
    with np.errstate(all="ignore"):
        single = [tuple(float(np.float32(number)) for number in each) for each in (sides, axes, middle)]
        data = mgh(
            two_boxes().astype(kind),
            sides=single[0],
            axes=single[1],
            middle=single[2],
            version=version,
            shape=shape,
            frames=frames,
            code=code,
            placed=placed,
        )
        data = data[: len(data) - cut]
        read_labels(packed(data) if pack else data, "labels.mgz")


@BRIEF
@given(st.lists(st.sampled_from(OBJ_LINES), max_size=30))
def test_obj(lines: list[str]) -> None:
    read_upload("\n".join(lines).encode(), "obj")


@settings(BRIEF, max_examples=50)
@given(
    method=st.sampled_from([zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA]),
    names=st.lists(words | st.sampled_from(["manifest.json", "stl/skin.stl", "/etc/passwd", "../../x", "a" * 5000]), max_size=4),
    content=st.binary(max_size=100)
    | st.just(b"[" * 100_000)
    | st.just(b'{"tissues": ' + b"9" * 5000 + b"}")
    | st.just(bytes(1 << 21)),
    flags=st.integers(0, 2**16 - 1),
    stated=lies,
    cut=st.integers(0, 40),
)
def test_package(method: int, names: list[str], content: bytes, flags: int, stated: int, cut: int) -> None:
    stream = BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        for name in dict.fromkeys(["manifest.json", *names]):
            archive.writestr(zipfile.ZipInfo(name), content, compress_type=method)
    data = bytearray(stream.getvalue())
    for mark, at in ((b"PK\x01\x02", 8), (b"PK\x03\x04", 6)):  # flags: encrypted, patched, UTF-8 names …
        place = data.find(mark)
        data[place + at : place + at + 2] = struct.pack("<H", flags)
    place = data.find(b"PK\x01\x02")
    data[place + 24 : place + 28] = struct.pack("<I", stated)  # unpacked size
    read_zip(bytes(data[: len(data) - cut]))
