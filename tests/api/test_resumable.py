"""Uploads in pieces: tus 1.0.0 as its specification says, and with a client of other people's making."""

from __future__ import annotations

import base64
import hashlib
import io
from datetime import timedelta
from typing import Any

import httpx
import pytest
from tusclient.client import TusClient

from api.partial_file import partial_file, sweep_partial_files
from store.records import UploadRow
from tests.api.live import Live

TUS = {"Tus-Resumable": "1.0.0"}
PIECE = {**TUS, "Content-Type": "application/offset+octet-stream"}


def encoded(**metadata: str) -> str:
    return ",".join(f"{name} {base64.b64encode(value.encode()).decode()}" for name, value in metadata.items())


def begin(api: Live, length: int, **metadata: str) -> httpx.Response:
    return api.client.post("/v1/uploads", headers={**TUS, "Upload-Length": str(length), "Upload-Metadata": encoded(**metadata)})


def begun(api: Live, length: int, **metadata: str) -> str:
    answer = begin(api, length, **metadata)
    assert answer.status_code == 201, answer.text
    return str(answer.headers["Location"])


def send(api: Live, upload: str, offset: int, data: bytes, **headers: str) -> httpx.Response:
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return api.client.patch(upload, content=data, headers={**PIECE, "Upload-Offset": str(offset), **named})


def received(api: Live, upload: str) -> int:
    answer = api.client.head(upload, headers=TUS)
    assert answer.status_code == 200
    assert answer.headers["Cache-Control"] == "no-store"
    return int(answer.headers["Upload-Offset"])


def code_of(answer: httpx.Response) -> tuple[int, str]:
    return answer.status_code, answer.json()["code"]


def test_the_server_says_what_it_knows(api: Live) -> None:
    answer = api.client.options("/v1/uploads")
    assert answer.status_code == 204
    assert answer.headers["Tus-Version"] == answer.headers["Tus-Resumable"] == "1.0.0"
    assert set(answer.headers["Tus-Extension"].split(",")) == {"creation", "expiration", "termination", "checksum"}
    assert answer.headers["Tus-Max-Size"] == str(64 * 1024)
    assert answer.headers["Tus-Checksum-Algorithm"].split(",")[0] == "sha1"


def test_a_file_in_pieces_becomes_a_mesh(api: Live, stl: bytes) -> None:
    upload = begun(api, len(stl), filename="skin.stl", unit="cm", name="a skin")
    assert received(api, upload) == 0
    first = send(api, upload, 0, stl[:100])
    assert (first.status_code, first.headers["Upload-Offset"]) == (204, "100")
    assert "Upload-Expires" in first.headers
    assert code_of(api.client.post(f"{upload}/mesh")) == (409, "upload.incomplete")
    assert send(api, upload, 100, stl[100:]).headers["Upload-Offset"] == str(len(stl))
    made = api.client.post(f"{upload}/mesh")
    assert made.status_code == 201
    mesh = made.json()
    assert (mesh["name"], mesh["unit"], mesh["file_name"]) == ("a skin", "cm", "skin.stl")
    assert mesh["sha256"] == hashlib.sha256(stl).hexdigest()
    assert api.client.post(f"{upload}/mesh").json()["id"] == mesh["id"]
    assert api.client.get(upload).json()["mesh"] == mesh["id"]
    assert not list((api.data_dir / "uploads").glob(upload.rpartition("/")[2])), "the blobs have it now"


def test_a_client_of_other_peoples_making(api: Live, stl: bytes) -> None:
    uploader = TusClient(f"{api.url}/v1/uploads").uploader(
        file_stream=io.BytesIO(stl), chunk_size=50, metadata={"filename": "skin.stl"}, upload_checksum=True
    )
    uploader.upload()
    made = api.client.post(f"{uploader.url}/mesh")
    assert made.json()["sha256"] == hashlib.sha256(stl).hexdigest()


def test_what_cannot_be_read_stays_and_can_be_read_otherwise(api: Live, stl: bytes) -> None:
    upload = begun(api, len(stl), filename="skin.stl", unit="parsec")
    send(api, upload, 0, stl)
    assert code_of(api.client.post(f"{upload}/mesh")) == (422, "unit.unknown")
    assert received(api, upload) == len(stl)
    assert api.client.post(f"{upload}/mesh", json={"unit": "in", "name": "again"}).json()["name"] == "again"


@pytest.mark.parametrize("algorithm", ["sha1", "sha256"])
def test_bytes_that_do_not_add_up_are_not_kept(api: Live, stl: bytes, algorithm: str) -> None:
    upload = begun(api, len(stl), filename="skin.stl")
    true = base64.b64encode(hashlib.new(algorithm, stl[:120]).digest()).decode()
    assert code_of(send(api, upload, 0, stl[1:121], Upload_Checksum=f"{algorithm} {true}")) == (460, "upload.checksum_mismatch")
    assert received(api, upload) == 0
    assert send(api, upload, 0, stl[:120], Upload_Checksum=f"{algorithm} {true}").status_code == 204
    assert send(api, upload, 120, stl[120:]).status_code == 204
    assert api.client.post(f"{upload}/mesh").json()["sha256"] == hashlib.sha256(stl).hexdigest()


def test_bytes_behind_the_acknowledged_ones_do_not_count(api: Live, stl: bytes) -> None:
    """A server that died between writing and acknowledging leaves such."""
    upload = begun(api, len(stl), filename="skin.stl")
    send(api, upload, 0, stl[:100])
    with (api.data_dir / "uploads" / upload.rpartition("/")[2]).open("ab") as file:
        file.write(b"never acknowledged")
    assert received(api, upload) == 100
    send(api, upload, 100, stl[100:])
    assert api.client.post(f"{upload}/mesh").json()["sha256"] == hashlib.sha256(stl).hexdigest()


def test_only_one_request_writes_at_a_time(api: Live, stl: bytes) -> None:
    upload = begun(api, len(stl))
    with partial_file(api.data_dir / "uploads", upload.rpartition("/")[2]):
        answer = send(api, upload, 0, stl)
        assert code_of(answer) == (423, "upload.busy")
        assert answer.json()["retryable"]
        assert api.client.get(upload).json()["received"] == 0, "who asks does not wait"
    assert send(api, upload, 0, stl).status_code == 204


def test_a_terminated_upload_is_gone(api: Live, stl: bytes) -> None:
    upload = begun(api, len(stl))
    send(api, upload, 0, stl[:100])
    assert api.client.delete(upload, headers=TUS).status_code == 204
    assert not (api.data_dir / "uploads" / upload.rpartition("/")[2]).exists()
    assert api.client.head(upload, headers=TUS).status_code == 404
    assert code_of(send(api, upload, 100, stl[100:])) == (404, "upload.not_found")
    assert code_of(api.client.delete(upload, headers=TUS)) == (404, "upload.not_found")


@pytest.mark.parametrize(
    ("headers", "expected"),
    [
        ({"Tus-Resumable": "0.2.2"}, (412, "upload.version")),
        ({"Upload-Length": "-1"}, (400, "upload.header_invalid")),
        ({"Upload-Length": "9" * 30}, (400, "upload.header_invalid")),
        ({"Upload-Length": str(10**12)}, (413, "upload.too_large")),
        ({"Upload-Metadata": "filename ***"}, (400, "upload.header_invalid")),
        ({"Upload-Metadata": "x" * 9000}, (400, "upload.header_invalid")),
    ],
)
def test_an_absurd_announcement_is_refused(api: Live, headers: dict[str, str], expected: Any) -> None:
    answer = api.client.post("/v1/uploads", headers={**TUS, "Upload-Length": "10", **headers})
    assert code_of(answer) == expected


@pytest.mark.parametrize(
    ("headers", "data", "expected"),
    [
        ({"Upload-Offset": "5"}, b"abc", (409, "upload.offset_differs")),
        ({"Upload-Offset": ""}, b"abc", (400, "upload.header_invalid")),
        ({"Content-Type": "text/plain"}, b"abc", (415, "request.media_type")),
        ({"Upload-Checksum": "md17 AAAA"}, b"abc", (400, "upload.header_invalid")),
        ({"Upload-Checksum": "sha1 ***"}, b"abc", (400, "upload.header_invalid")),
        ({}, b"more than the ten bytes", (413, "upload.too_large")),
        ({"Tus-Resumable": ""}, b"abc", (412, "upload.version")),
    ],
)
def test_an_absurd_piece_is_refused_and_leaves_nothing(api: Live, headers: dict[str, str], data: bytes, expected: Any) -> None:
    upload = begun(api, 10)
    answer = api.client.patch(upload, content=data, headers={**PIECE, "Upload-Offset": "0", **headers})
    assert code_of(answer) == expected
    assert received(api, upload) == 0


def test_hostile_names_stay_names(api: Live, stl: bytes) -> None:
    upload = begun(api, len(stl), filename="../../etc/passwd\x00\n")
    assert api.client.get(upload).json()["file_name"] == "passwd"
    for path in ("/v1/uploads/..%2f..%2fetc", "/v1/uploads/abc"):
        assert api.client.head(path, headers=TUS).status_code == 404


def test_an_abandoned_upload_is_swept(api: Live, stl: bytes) -> None:
    upload = begun(api, len(stl)).rpartition("/")[2]
    kept = begun(api, len(stl)).rpartition("/")[2]
    for each in (upload, kept):
        send(api, f"/v1/uploads/{each}", 0, stl[:10])
    with api.services.db.session() as session:
        row = session.get(UploadRow, upload)
        assert row is not None
        row.expires_at -= timedelta(days=3)
    assert api.services.uploads.sweep() == 1
    assert sweep_partial_files(api.services.uploads_dir, api.services.uploads.known) >= 1
    assert not (api.services.uploads_dir / upload).exists()
    assert (api.services.uploads_dir / kept).exists()
    assert api.client.get(f"/v1/uploads/{upload}").status_code == 404
