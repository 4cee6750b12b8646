from __future__ import annotations

import json
import zlib
from pathlib import Path

import numpy as np
import pytest

from core.errors import InternalError
from core.io import canonical
from core.io.array_file import PREFIX
from subjects.body import body
from tests.core.io.tiny import TETRAHEDRON, jagged


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "0.mesh"


def test_every_bit_comes_back_read_only(file: Path) -> None:
    canonical.save(jagged(), file)
    mesh = canonical.load(file)
    assert mesh.vertices.tobytes() == jagged().vertices.tobytes()
    assert np.array_equal(mesh.faces, jagged().faces)
    assert not mesh.vertices.flags.writeable


def test_named_arrays_come_back(file: Path) -> None:
    arrays = {"depth_mm": np.arange(4.0), "normal": np.ones((4, 3)), "vertices": np.arange(4, dtype=np.int32)}
    canonical.save(TETRAHEDRON, file, arrays)
    mesh, loaded = canonical.load_with_arrays(file)
    assert len(mesh.vertices) == 4
    assert {name: (values.dtype, values.tolist()) for name, values in loaded.items()} == {
        name: (values.dtype, values.tolist()) for name, values in arrays.items()
    }


def test_equal_meshes_give_equal_bytes(file: Path) -> None:
    canonical.save(TETRAHEDRON, file, {"b": np.zeros(4), "a": np.ones(4)})
    first = file.read_bytes()
    canonical.save(TETRAHEDRON.with_vertices(TETRAHEDRON.vertices), file, {"a": np.ones(4), "b": np.zeros(4)})
    assert file.read_bytes() == first


def test_arrays_lie_at_multiples_of_64_bytes(file: Path) -> None:
    mesh = body(0)
    canonical.save(mesh, file)
    data = file.read_bytes()
    place = data.index(mesh.vertices.tobytes())
    assert place % 64 == 0
    assert np.array_equal(np.memmap(file, "<f8", "r", place, mesh.vertices.shape), mesh.vertices)


@pytest.mark.parametrize("values", [np.zeros(3), np.zeros(4, dtype=np.float32), np.array(["a"] * 4)])
def test_arrays_that_do_not_fit_are_refused(file: Path, values: np.ndarray) -> None:
    with pytest.raises(ValueError, match="a row per vertex"):
        canonical.save(TETRAHEDRON, file, {"x": values})


def test_no_flipped_bit_and_no_lost_byte_goes_unnoticed(file: Path) -> None:
    canonical.save(TETRAHEDRON, file)
    good = file.read_bytes()
    damaged = [good[:length] for length in range(len(good))]
    damaged += [good[:place] + bytes([good[place] ^ 0x10]) + good[place + 1 :] for place in range(len(good))]
    for content in [*damaged, good + bytes(64)]:
        file.write_bytes(content)
        with pytest.raises(InternalError) as caught:
            canonical.load(file)
        assert caught.value.code == "canonical.corrupt"


@pytest.mark.parametrize(
    "directory",
    [
        b"[]",
        b"{}",
        b"[1]",
        b"not json",
        b"\xff\xff",
        b'[{"name":"vertices","type":"<f8","shape":[-1,3]}]',
        b'[{"name":"vertices","type":"|O","shape":[1]}]',
        b'[{"name":"vertices","type":"<f8","shape":[4]},{"name":"faces","type":"<i4","shape":[0]}]',
        b"[" * 100_000,
    ],
)
def test_a_directory_that_describes_no_mesh_is_corrupt(file: Path, directory: bytes) -> None:
    padded = directory + bytes(-(len(directory) + PREFIX.size) % 64)
    rest = padded + bytes(64)
    file.write_bytes(PREFIX.pack(canonical.MAGIC, len(padded), zlib.crc32(rest)) + rest)
    with pytest.raises(InternalError, match="does not describe") as caught:
        canonical.load(file)
    assert caught.value.code == "canonical.corrupt"


def test_the_directory_is_json_without_code(file: Path) -> None:
    canonical.save(TETRAHEDRON, file)
    data = file.read_bytes()
    _, size, _ = PREFIX.unpack_from(data)
    entries = json.loads(data[PREFIX.size : PREFIX.size + size].rstrip(b"\0"))
    assert entries == [{"name": "vertices", "type": "<f8", "shape": [4, 3]}, {"name": "faces", "type": "<i4", "shape": [4, 3]}]
