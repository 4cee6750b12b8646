"""Files made to do harm, through HTTP: refused by name, nothing kept, nothing of the host told, the server's memory as before."""

from __future__ import annotations

import gzip
import io
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import psutil
import pytest

from store.settings import Settings
from tests.api.live import Live, serving
from tests.core.io import matlab_bytes as craft
from tests.core.io.stl_bytes import binary_stl
from tests.core.io.tiny import TETRAHEDRON

P, T = TETRAHEDRON.vertices, TETRAHEDRON.faces + 1.0
SECRET = "0123456789-secret-of-the-host"
GROWTH_BYTES = 128 << 20


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    settings = Settings(
        data_dir=tmp_path_factory.mktemp("hostile"),
        broker_url="redis://127.0.0.1:1/0",
        upload_limit_bytes=8 << 20,
        intake_memory_bytes=512 << 20,
        intake_wall_s=60,
    )
    with serving(settings) as live:
        yield live


def hdf5(fill: Callable[[h5py.File, Path], None], secret: Path) -> bytes:
    stream = io.BytesIO()
    with h5py.File(stream, "w", libver="latest") as content:
        content["t"] = T.T
        fill(content, secret)
    return stream.getvalue()


def external_storage(content: h5py.File, secret: Path) -> None:
    content.create_dataset("P", (3, 1), "<f8", external=[(str(secret), 0, 24)])


def external_link(content: h5py.File, secret: Path) -> None:
    content["P"] = h5py.ExternalLink(str(secret), "/P")


def link_on_the_way(content: h5py.File, secret: Path) -> None:
    content.create_group("g")["inner"] = h5py.ExternalLink(str(secret), "/")
    content["P"] = h5py.SoftLink("/g/inner/P")


def virtual(content: h5py.File, secret: Path) -> None:
    layout = h5py.VirtualLayout(shape=P.T.shape, dtype="<f8")
    layout[:] = h5py.VirtualSource(str(secret), "P", shape=P.T.shape)
    content.create_virtual_dataset("P", layout)


def references(content: h5py.File, _secret: Path) -> None:
    content.create_dataset("P", (3, 4), h5py.ref_dtype)[0, 0] = content["t"].ref


def unknown_filter(content: h5py.File, _secret: Path) -> None:
    content.create_dataset("P", data=P.T, compression="lzf")


def gzip_bomb(content: h5py.File, _secret: Path) -> None:
    content.create_dataset("P", (3, 20_000_000), "<f8", chunks=(3, 1_000_000), compression="gzip", compression_opts=9)
    content["P"][:, :1_000_000] = 0.0


def lying_chunk(content: h5py.File, _secret: Path) -> None:
    dataset = content.create_dataset("P", (3, 4), "<f8", chunks=(3, 4), compression="gzip")
    dataset.id.write_direct_chunk((0, 0), zlib.compress(bytes(256 << 20), 9))


def mat5_bomb(_secret: Path) -> bytes:
    """Half a megabyte that unpacks to half a gigabyte, as stated."""
    size = 512 << 20
    packer = zlib.compressobj(9)
    head = craft.head("P", (size // 24, 3), craft.DOUBLE) + struct.pack("<II", craft.DOUBLES, size // 24 * 24)
    packed = packer.compress(struct.pack("<II", craft.MATRIX, len(head) + size) + head)
    packed += b"".join(packer.compress(bytes(1 << 20)) for _ in range(512)) + packer.flush()
    return craft.mat_file(struct.pack("<II", craft.COMPRESSED, len(packed)) + packed, craft.matrix("t", T))


PICKLE = f'cbuiltins\nexec\n(S\'open("/tmp/{SECRET}", "w")\'\ntR.'.encode()  # what whoever unpickles it would run


def pickled_array(_secret: Path) -> bytes:
    stream = io.BytesIO()
    np.lib.format.write_array_header_1_0(stream, {"descr": "|O", "fortran_order": False, "shape": (1,)})
    return stream.getvalue() + PICKLE


def packed(_secret: Path) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("../../skin.stl", bytes(64 << 20))
    return stream.getvalue()


def ply_of(count: str) -> bytes:
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\nproperty double x\nproperty double y\nproperty double z\n"
    )
    return (head + "element face 4\nproperty list uint uint vertex_indices\nend_header\n").encode() + b"\xff" * 400


FILES: dict[str, tuple[str, Callable[[Path], bytes]]] = {
    **{
        f"hdf5 {fill.__name__}": ("skin.mat", lambda secret, fill=fill: hdf5(fill, secret))  # type: ignore[misc]
        for fill in (
            *(external_storage, external_link, link_on_the_way, virtual, references, unknown_filter, gzip_bomb, lying_chunk),
        )
    },
    "mat5 bomb": ("skin.mat", mat5_bomb),
    "mat5 function": ("skin.mat", lambda _: craft.mat_file(craft.function_handle("P"), craft.matrix("t", T))),
    "mat5 deep cells": (
        "skin.mat",
        lambda _: craft.mat_file(
            craft.matrix("t", T), craft.element(14, craft.head("P", (1, 1), 1) + struct.pack("<II", 14, 8) * 50_000)
        ),
    ),
    "pickle": ("skin.mat", lambda _: PICKLE),
    "pickled array": ("skin.npy", pickled_array),
    "zip": ("skin.stl", packed),
    "gzip": ("skin.stl", lambda _: gzip.compress(bytes(64 << 20))),
    "stl of 4 billion": ("skin.stl", lambda _: binary_stl(count=2**32 - 1)),
    "ply of 4 billion": ("skin.ply", lambda _: ply_of(str(2**32))),
    "ply of digits": ("skin.ply", lambda _: ply_of("9" * 5000)),
    "obj of one line": ("skin.obj", lambda _: b"v 0 0 0\nf " + b"2 " * 1_000_000),
    "obj of digits": ("skin.obj", lambda _: b"v " + b"9" * 1_000_000 + b" 0 0\nf 1 1 1\n"),
    "obj to files": ("skin.obj", lambda secret: f"mtllib {secret}\ncall {secret}\nv 0 0 0\nf 1 2 3\n".encode()),
    "stl of one word": ("skin.stl", lambda _: b"solid " + b"a" * 4_000_000),
}


@pytest.mark.parametrize("case", FILES)
def test_files_made_to_do_harm_do_none(live: Live, tmp_path: Path, case: str) -> None:
    file_name, make = FILES[case]
    secret = tmp_path / "secret.h5"
    with h5py.File(secret, "w") as content:
        content["P"] = P.T
        content.attrs["secret"] = SECRET
    data = make(secret)
    assert len(data) < 8 << 20
    before = psutil.Process().memory_info().rss
    response = live.upload(data, file_name)
    assert response.status_code in (413, 415, 422), response.text
    problem = response.json()
    assert response.headers["content-type"] == "application/problem+json"
    assert problem["code"].split(".")[0] in {"mat", "hdf5", "stl", "ply", "obj", "mesh", "format", "limit"}, problem
    assert problem["retryable"] is False
    assert SECRET not in response.text
    assert str(live.data_dir) not in response.text
    assert psutil.Process().memory_info().rss - before < GROWTH_BYTES
    assert (live.incoming(), live.blob_names()) == ([], set())
    assert not Path(f"/tmp/{SECRET}").exists()
    assert live.client.get("/v1/meshes").json()["meshes"] == []


def test_after_all_that_a_good_file_is_taken(live: Live) -> None:
    assert live.upload(binary_stl()).status_code == 201
