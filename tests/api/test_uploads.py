"""Uploads: what is taken, what is refused, and that nothing is left of what was refused."""

from __future__ import annotations

import hashlib
import http.client
import io
import os
import resource
import socket
import threading
from pathlib import Path

import h5py
import httpx
import numpy as np
import pytest
from scipy.io import savemat

from store.settings import Settings
from tests.api.live import Live, problem_of, serving
from tests.core.io.matlab_bytes import element, function_handle, mat_file, matrix, opaque_object
from tests.core.io.stl_bytes import binary_stl, facet
from tests.core.io.tiny import CORNERS_MM, TRIANGLES

P, T = np.array(CORNERS_MM), np.array(TRIANGLES) + 1.0


def saved(**variables: object) -> bytes:
    """A MAT file of version 5."""
    target = io.BytesIO()
    savemat(target, variables)
    return target.getvalue()


def hdf5(folder: Path, *, linked: bool = False) -> bytes:
    """A MAT file of version 7.3; with `linked`, its P is a link into another file."""
    path = folder / "73.mat"
    with h5py.File(path, "w", userblock_size=512) as content:
        content.create_dataset("t", data=T.T).attrs["MATLAB_class"] = np.bytes_("double")
        if linked:
            content["P"] = h5py.ExternalLink("/etc/passwd", "/P")
        else:
            content.create_dataset("P", data=P.T).attrs["MATLAB_class"] = np.bytes_("double")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, by hand".ljust(124) + b"\x00\x02IM")
    return path.read_bytes()


def ascii_stl(number: str) -> bytes:
    """One facet with one coordinate as told."""
    lines = ["solid s", "facet normal 0 0 0", "outer loop", f"vertex {number} 0 0", "vertex 100 0 0", "vertex 0 100 0"]
    return "\n".join([*lines, "endloop", "endfacet", "endsolid s", ""]).encode()


def obj(face: str) -> bytes:
    """Four corners and one face."""
    return "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS_MM).encode() + f"f {face}\n".encode()


NAN_STL = binary_stl()[:80] + (1).to_bytes(4, "little") + facet([[float("nan"), 0, 0], [100, 0, 0], [0, 100, 0]])

# file name, bytes, status, code, what the detail must say
REFUSED = {
    "empty": ("skin.stl", b"", 422, "upload.empty", ""),
    "text": ("skin.stl", b"this is a letter, not a mesh\n" * 20, 422, "stl.not_stl", ""),
    "count one too many": ("skin.stl", binary_stl(count=5), 422, "stl.", "5"),
    "count 4 billion": ("skin.stl", binary_stl(count=4_294_967_295), 422, "stl.", "4294967295"),
    "count too small": ("skin.stl", binary_stl(count=2), 422, "stl.count_mismatch", "2"),
    "cut off": ("skin.stl", binary_stl()[:-20], 422, "stl.", "264"),
    "NaN": ("skin.stl", NAN_STL, 422, "mesh.not_finite", "1 of 3"),
    "infinite": ("skin.stl", ascii_stl("1e400"), 422, "mesh.not_finite", "1 of 3"),
    "1e300": ("skin.stl", ascii_stl("1e300"), 422, "mesh.coordinate_out_of_range", "1e+300"),
    "index out of range": ("skin.obj", obj("1 2 9"), 422, "mesh.index_out_of_range", "9"),
    "zero-based t": ("skin.mat", saved(P=P, t=T - 1), 422, "mat.zero_based", "0"),
    "t out of range": ("skin.mat", saved(P=P, t=T + 1), 422, "mesh.index_out_of_range", "5"),
    "no P": ("skin.mat", saved(t=T), 422, "mat.variable_missing", "P"),
    "no t": ("skin.mat", saved(P=P), 422, "mat.variable_missing", "t"),
    "function handle": ("skin.mat", mat_file(matrix("t", T), function_handle("P")), 422, "mat.class_refused", "P"),
    "object": ("skin.mat", mat_file(matrix("P", P), opaque_object("t")), 422, "mat.class_refused", "t"),
    "broken MAT": ("skin.mat", mat_file(element(14, b"\xff" * 64)), 422, "mat.corrupt", ""),
    "unknown": ("skin.xyz", bytes(range(256)) * 4, 415, "format.unknown", "xyz"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_files_are_refused_by_name_and_leave_nothing(api: Live, case: str) -> None:
    file_name, data, status, code, said = REFUSED[case]
    blobs, meshes = api.blob_names(), api.client.get("/v1/meshes").json()["meshes"]
    response = api.upload(data, file_name)
    problem = problem_of(response, status, response.json()["code"])
    assert problem["code"].startswith(code)
    assert said in problem["detail"]
    assert not problem["retryable"]
    assert api.incoming() == []
    assert api.blob_names() == blobs
    assert api.client.get("/v1/meshes").json()["meshes"] == meshes


@pytest.mark.parametrize(("linked", "cut", "code"), [(True, None, "hdf5.link_refused"), (False, -400, "hdf5.corrupt")])
def test_bad_hdf5_is_refused(api: Live, tmp_path: Path, linked: bool, cut: int | None, code: str) -> None:
    problem_of(api.upload(hdf5(tmp_path, linked=linked)[:cut], "skin.mat"), 422, code)
    assert api.incoming() == []


def test_good_files_of_every_format_become_the_same_mesh(api: Live, tmp_path: Path, stl: bytes) -> None:
    files = {
        "skin.stl": stl,
        "skin.mat": saved(P=P, t=T),
        "skin73.mat": hdf5(tmp_path),
        "skin.obj": obj("1 2 3") + b"f 1 2 4\nf 1 3 4\nf 2 3 4\n",
    }
    for name, data in files.items():
        response = api.upload(data, name)
        assert response.status_code == 201, response.text
        told = response.json()
        assert (told["vertices"], told["faces"], told["extents_mm"]) == (4, 4, [100.0, 100.0, 100.0])
        assert (told["size_bytes"], told["sha256"]) == (len(data), hashlib.sha256(data).hexdigest())
        assert (told["file_name"], told["name"], told["unit"]) == (name, name.split(".")[0], "mm")
        assert response.headers["Location"] == f"/v1/meshes/{told['id']}"
        assert api.client.get(response.headers["Location"]).json() == told


def test_units_are_converted_and_a_suspicious_one_is_told_not_changed(api: Live, stl: bytes) -> None:
    told = api.upload(stl, unit="cm").json()
    assert told["extents_mm"] == [1000.0, 1000.0, 1000.0]
    told = api.upload(stl, unit="m").json()
    assert told["extents_mm"] == [100_000.0] * 3
    assert [finding["code"] for finding in told["findings"]] == ["mesh.unit_suspicious"]
    problem_of(api.upload(stl, unit="furlong"), 422, "unit.unknown")


def test_names_are_made_fit_to_show(api: Live, stl: bytes) -> None:
    told = api.upload(stl, "..\\..\\Ich & Körper.stl", name="  my\tskin  ").json()
    assert told["file_name"] == "Ich & Körper.stl"
    assert told["name"] == "my skin"


def test_a_file_over_the_limit_is_refused_whether_announced_or_not(api: Live) -> None:
    limit = api.services.settings.upload_limit_bytes
    announced = api.upload(b"\0" * (limit + 100_000))
    problem = problem_of(announced, 413, "upload.too_large")
    assert problem["facts"]["limit_bytes"] == limit
    boundary = "b" * 20
    head = f'--{boundary}\r\nContent-Disposition: form-data; name="file"; filename="a.stl"\r\n\r\n'.encode()
    pieces = iter([head, *[b"\0" * 10_000] * 30, f"\r\n--{boundary}--\r\n".encode()])
    chunked = api.client.post("/v1/meshes", content=pieces, headers={"Content-Type": f"multipart/form-data; boundary={boundary}"})
    assert str(limit) in problem_of(chunked, 413, "upload.too_large")["detail"]
    assert api.incoming() == []


def test_one_byte_decides(tmp_path: Path, stl: bytes) -> None:
    for spare, status in ((0, 201), (-1, 413)):
        settings = Settings(data_dir=tmp_path / str(spare), upload_limit_bytes=len(stl) + spare)
        with serving(settings) as live:
            assert live.upload(stl).status_code == status


def test_an_upload_refused_by_its_length_is_not_even_asked_for(api: Live) -> None:
    """With Expect: 100-continue curl and others wait: the refusal must come instead of the go-ahead."""
    port = httpx.URL(api.url).port
    with socket.create_connection(("127.0.0.1", port), timeout=10) as connection:
        connection.sendall(
            b"POST /v1/meshes HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: multipart/form-data; boundary=b\r\n"
            b"Content-Length: 999999999\r\nExpect: 100-continue\r\n\r\n"
        )
        assert connection.recv(4096).startswith(b"HTTP/1.1 413 ")


def test_a_broken_connection_leaves_nothing(api: Live) -> None:
    meshes = api.client.get("/v1/meshes").json()["meshes"]
    port = httpx.URL(api.url).port
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    connection.putrequest("POST", "/v1/meshes")
    connection.putheader("Content-Type", "multipart/form-data; boundary=b")
    connection.putheader("Content-Length", "60000")
    connection.endheaders()
    connection.send(b'--b\r\nContent-Disposition: form-data; name="file"; filename="a.stl"\r\n\r\n' + b"\0" * 20_000)
    seen = threading.Event()
    for _ in range(200):
        if api.incoming():
            break
        seen.wait(0.05)
    assert api.incoming()
    connection.close()
    for _ in range(200):
        if not api.incoming():
            break
        seen.wait(0.05)
    assert api.incoming() == []
    assert api.client.get("/v1/meshes").json()["meshes"] == meshes


def form(*parts: tuple[str, bytes], end: bytes = b"--b--\r\n") -> bytes:
    """A multipart body with boundary b."""
    return (
        b"".join(f"--b\r\nContent-Disposition: form-data; {head}\r\n\r\n".encode() + body + b"\r\n" for head, body in parts) + end
    )


FILE = 'name="file"; filename="a.stl"'
BAD_FORMS = {
    "no file": (form(('name="unit"', b"mm")), 422, "upload.file_missing"),
    "file without a name": (form(('name="file"', b"x")), 422, "upload.file_missing"),
    "unknown part": (form((FILE, b"x"), ('name="colour"', b"red")), 422, "upload.field_unknown"),
    "two files": (form((FILE, b"x"), (FILE, b"y")), 422, "upload.field_unknown"),
    "long field": (form(('name="name"', b"n" * 3000), (FILE, b"x")), 422, "upload.field_too_long"),
    "cut off": (form((FILE, b"x"), end=b""), 400, "request.malformed"),
    "no form": (b"hello", 400, "request.malformed"),
    "nothing": (b"", 400, "request.malformed"),
}


@pytest.mark.parametrize("case", BAD_FORMS)
def test_bad_forms_are_refused(api: Live, case: str) -> None:
    body, status, code = BAD_FORMS[case]
    response = api.client.post("/v1/meshes", content=body, headers={"Content-Type": "multipart/form-data; boundary=b"})
    problem_of(response, status, code)
    assert api.incoming() == []


def test_other_bodies_are_refused(api: Live, stl: bytes) -> None:
    problem = problem_of(api.client.post("/v1/meshes", content=stl), 415, "request.media_type")
    assert "multipart/form-data" in problem["detail"]
    problem_of(
        api.client.post("/v1/meshes", content=b"x", headers={"Content-Type": "multipart/form-data"}), 400, "request.malformed"
    )


def test_a_parser_that_needs_too_much_memory_is_stopped(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path, intake_memory_bytes=16 * 1024**2, upload_limit_bytes=10**8)
    rows = np.zeros((1_000_000, 3))
    with serving(settings) as live:
        problem_of(live.upload(saved(P=rows, t=T), "big.mat"), 413, "limit.memory")
        assert live.incoming() == []
        assert live.blob_names() == set()


def test_a_disk_without_room_is_told_and_left_clean(tmp_path: Path) -> None:
    """A limit on the size of files ends a write as a full disk does."""
    with serving(Settings(data_dir=tmp_path)) as live:
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1024**2, hard))
        try:
            response = live.upload(b"\0" * 3 * 1024**2)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        problem_of(response, 507, "storage.full")
        assert live.incoming() == []
        assert live.upload(binary_stl()).status_code == 201


def test_the_same_upload_twice_under_one_key_is_one_mesh(api: Live, stl: bytes) -> None:
    def send(data: bytes) -> httpx.Response:
        return api.client.post("/v1/meshes", files={"file": ("a.stl", data)}, headers={"Idempotency-Key": "upload-of-this-test"})

    first, second = send(stl), send(stl)
    assert (first.status_code, second.status_code) == (201, 201)
    assert first.json() == second.json()
    assert "Idempotent-Replayed" not in first.headers
    assert second.headers["Idempotent-Replayed"] == "true"
    problem_of(send(binary_stl(header=b"other")), 422, "idempotency.mismatch")


def test_a_refused_upload_frees_its_key(api: Live, stl: bytes) -> None:
    for data, status in ((b"", 422), (stl, 201)):
        response = api.client.post("/v1/meshes", files={"file": ("a.stl", data)}, headers={"Idempotency-Key": "tried-twice"})
        assert response.status_code == status


def test_what_a_killed_server_left_is_swept_at_the_next_start(tmp_path: Path) -> None:
    incoming = tmp_path / "incoming"
    old, young = incoming / "old", incoming / "young"
    for folder in (old, young):
        folder.mkdir(parents=True)
        (folder / "upload").write_bytes(b"half a file")
    for path in (old / "upload", old):
        os.utime(path, (0, 0))
    with serving(Settings(data_dir=tmp_path)):
        assert sorted(incoming.iterdir()) == [young]
