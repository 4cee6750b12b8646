"""Damaged files of every format: a mesh or a named error within bounded memory, never another exception."""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterator
from contextlib import suppress
from io import BytesIO
from pathlib import Path

import h5py
import numpy as np
import psutil
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.errors import InputError, LimitError
from core.io.registry import WRITERS, read_meshes, write_mesh
from core.mesh import Mesh
from tests.core.io import matlab_bytes as craft
from tests.core.io.tiny import TETRAHEDRON

MEMORY_BYTES = 1 << 30  # more than this process has already
P, T = TETRAHEDRON.vertices, TETRAHEDRON.faces + 1.0


def by_writer(name: str) -> Callable[[Path], bytes]:
    def make(folder: Path) -> bytes:
        write_mesh(TETRAHEDRON, folder / "good", name, "skin")
        return (folder / "good").read_bytes()

    return make


def compressed_mat(_folder: Path) -> bytes:
    return craft.mat_file(craft.compressed(craft.matrix("P", P)), craft.compressed(craft.matrix("t", T)))


def mat73(**options: object) -> Callable[[Path], bytes]:
    def make(_folder: Path) -> bytes:
        stream = BytesIO()
        with h5py.File(stream, "w") as content:
            for name, array in (("P", P), ("t", T)):
                content.create_dataset(name, data=array.T, **options).attrs["MATLAB_class"] = np.bytes_("double")
        return stream.getvalue()

    return make


def ascii_ply(_folder: Path) -> bytes:
    header = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    rows = "".join(" ".join(map(str, point)) + "\n" for point in P.tolist())
    faces = "4 0 1 2 3\n3 0 1 3\n"
    return (header + "element face 2\nproperty list uchar int vertex_indices\nend_header\n" + rows + faces).encode()


FILES: dict[str, tuple[str, Callable[[Path], bytes]]] = {
    **{name: (name.removesuffix("-ascii"), by_writer(name)) for name in WRITERS},
    "mat-compressed": ("mat", compressed_mat),
    "mat73": ("mat", mat73()),
    "mat73-chunks": ("mat", mat73(chunks=(3, 2), compression="gzip", shuffle=True, fletcher32=True)),
    "ply-ascii": ("ply", ascii_ply),
}


@pytest.fixture(scope="module", autouse=True)
def bounded_memory() -> Iterator[None]:
    """A MemoryError fails the test: damage must be seen before memory is asked for."""
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (psutil.Process().memory_info().vms + MEMORY_BYTES, hard))
    yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@pytest.mark.timeout(60)
@pytest.mark.parametrize("name", FILES)
@settings(max_examples=300, derandomize=True, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_damage_is_named_or_harmless(tmp_path: Path, name: str, data: st.DataObject) -> None:
    extension, make = FILES[name]
    content = bytearray(make(tmp_path))
    places = st.integers(0, len(content) - 1)
    for place, value in data.draw(st.lists(st.tuples(places, st.integers(0, 255)), max_size=6), label="flips"):
        content[place] = value
    if data.draw(st.booleans(), label="cut"):
        del content[data.draw(places, label="at") :]
    (tmp_path / "upload").write_bytes(content)
    with suppress(InputError, LimitError):
        intake = read_meshes(tmp_path / "upload", file_name=f"skin.{extension}", unit="mm")
        assert all(isinstance(named.mesh, Mesh) for named in intake.meshes)


@settings(max_examples=300, derandomize=True, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(content=st.binary(min_size=1, max_size=300), extension=st.sampled_from(["stl", "mat", "ply", "obj", "", "txt"]))
def test_noise_is_named(tmp_path: Path, content: bytes, extension: str) -> None:
    (tmp_path / "upload").write_bytes(content)
    with pytest.raises((InputError, LimitError)):
        read_meshes(tmp_path / "upload", file_name=f"skin.{extension}", unit="mm")
