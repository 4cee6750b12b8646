"""One upload, several API hosts: they share database and object store, or only the database."""

from __future__ import annotations

import hashlib
import os
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from datetime import timedelta
from pathlib import Path
from typing import BinaryIO

import httpx
import pytest

from api import request_body, upload_target
from core.errors import InternalError
from store.blobs import Blob
from store.database import Database
from store.records import UploadPartRow, UploadRow
from store.references import References
from store.settings import Settings
from tests.api.live import Live, serving
from tests.api.test_resumable import PIECE, begun, code_of, received, send
from tests.seaweed import SeaweedServer


@contextmanager
def hosts(folder: Path, blobs_url: str) -> Iterator[list[Live]]:
    """Two of them, each with a data folder of its own."""
    with ExitStack() as stack:
        yield [
            stack.enter_context(
                serving(
                    Settings(
                        data_dir=folder / name, database_url=f"sqlite:///{folder}/shared.sqlite3", blobs_url=blobs_url, port=0
                    )
                )
            )
            for name in ("one", "two")
        ]


@pytest.fixture
def pair(tmp_path: Path, seaweed: SeaweedServer) -> Iterator[list[Live]]:
    with hosts(tmp_path, seaweed.new_bucket()) as there:
        yield there


def test_the_pieces_of_a_file_may_go_to_any_host(pair: list[Live], stl: bytes) -> None:
    one, two = pair
    upload = begun(one, len(stl), filename="skin.stl")
    assert send(one, upload, 0, stl[:100]).status_code == 204
    assert received(two, upload) == 100
    assert code_of(two.client.post(f"{upload}/mesh")) == (409, "upload.incomplete")
    assert code_of(send(two, upload, 40, stl[40:])) == (409, "upload.offset_differs")
    assert send(two, upload, 100, stl[100:200]).status_code == 204
    assert send(one, upload, 200, stl[200:]).status_code == 204
    kept = References(one.services.db).all()
    assert len(kept) == 3, "a sweep leaves the parts alone"
    made = two.client.post(f"{upload}/mesh")
    assert made.status_code == 201, made.text
    assert made.json()["sha256"] == hashlib.sha256(stl).hexdigest()
    assert one.client.post(f"{upload}/mesh").json()["id"] == made.json()["id"]
    assert not kept & References(one.services.db).all(), "the parts are not needed any more"
    assert two.is_clean()


def test_a_long_request_is_kept_in_parts(pair: list[Live], stl: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(upload_target.StoredParts, "kept_every_bytes", 50)
    monkeypatch.setattr(request_body, "PIECE_BYTES", 20)
    one, two = pair
    upload = begun(one, len(stl), filename="skin.stl")

    def pieces() -> Iterator[bytes]:
        yield stl[:-10]
        deadline = time.monotonic() + 20
        while received(two, upload) < len(stl) - 10:
            assert time.monotonic() < deadline
            time.sleep(0.02)
        raise ConnectionError("the client goes away")

    with pytest.raises((httpx.TransportError, ConnectionError)):
        one.client.patch(
            upload,
            content=pieces(),
            headers={**PIECE, "Upload-Offset": "0"},
        )
    assert send(two, upload, len(stl) - 10, stl[-10:]).status_code == 204
    assert one.client.post(f"{upload}/mesh").json()["sha256"] == hashlib.sha256(stl).hexdigest()


def test_bytes_behind_a_part_that_was_lost_do_not_count(pair: list[Live], stl: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    """The store refuses the second part while the third comes in."""
    monkeypatch.setattr(upload_target.StoredParts, "kept_every_bytes", 50)
    monkeypatch.setattr(request_body, "PIECE_BYTES", 50)
    one, _ = pair
    upload, blobs = begun(one, len(stl), filename="skin.stl"), one.services.blobs
    put, sizes = blobs.put_open, []

    def put_open(file: BinaryIO) -> Blob:
        sizes.append(os.fstat(file.fileno()).st_size)
        if len(sizes) == 2:
            raise InternalError("blobs.unavailable", "the object store does not answer")
        return put(file)

    monkeypatch.setattr(blobs, "put_open", put_open)

    def pieces() -> Iterator[bytes]:
        for number, start in enumerate((0, 60, 120)):
            deadline = time.monotonic() + 20
            while len(sizes) < number:
                assert time.monotonic() < deadline
                time.sleep(0.02)
            yield stl[start : start + 60]

    answer = one.client.patch(upload, content=pieces(), headers={**PIECE, "Upload-Offset": "0"})
    assert code_of(answer) == (503, "blobs.unavailable")
    assert sizes == [60, 60]
    assert received(one, upload) == 60
    assert send(one, upload, 60, stl[60:]).status_code == 204
    assert one.client.post(f"{upload}/mesh").json()["sha256"] == hashlib.sha256(stl).hexdigest()


def test_a_part_that_rotted_in_the_store_makes_no_mesh(pair: list[Live], stl: bytes, seaweed: SeaweedServer) -> None:
    one, two = pair
    upload = begun(one, len(stl), filename="skin.stl")
    assert send(one, upload, 0, stl).status_code == 204
    bucket, sha256 = one.services.settings.blobs_url.rpartition("/")[2], hashlib.sha256(stl).hexdigest()
    rotten = stl[:-1] + bytes([stl[-1] ^ 1])
    seaweed.client().put_object(Bucket=bucket, Key=f"{sha256[:2]}/{sha256[2:4]}/{sha256}", Body=rotten)
    assert code_of(two.client.post(f"{upload}/mesh")) == (500, "blob.corrupt")


def test_of_two_hosts_that_write_at_one_place_one_is_first(pair: list[Live], stl: bytes) -> None:
    upload = begun(pair[0], len(stl), filename="skin.stl")
    answers: list[httpx.Response] = []
    threads = [
        threading.Thread(target=lambda host=host: answers.append(send(host, upload, 0, stl)))  # type: ignore[misc]
        for host in pair
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(answer.status_code for answer in answers) == [204, 409]
    assert received(pair[0], upload) == len(stl)
    assert pair[1].client.post(f"{upload}/mesh").json()["sha256"] == hashlib.sha256(stl).hexdigest()


def test_an_upload_that_is_forgotten_takes_its_parts_along(pair: list[Live], stl: bytes) -> None:
    one, two = pair
    terminated, expired = (begun(one, len(stl)) for _ in range(2))
    for upload in (terminated, expired):
        assert send(one, upload, 0, stl[:100]).status_code == 204
    assert two.client.delete(terminated, headers={"Tus-Resumable": "1.0.0"}).status_code == 204
    with one.services.db.session() as session:
        row = session.get(UploadRow, expired.rpartition("/")[2])
        assert row is not None
        row.expires_at -= timedelta(days=3)
    assert one.services.uploads.sweep() == 1
    assert count_parts(one.services.db) == 0
    assert one.services.blobs.sweep(References(one.services.db).all(), older_than_s=-5.0)


def count_parts(database: Database) -> int:
    with database.reading() as session:
        return session.query(UploadPartRow).count()


def test_without_a_common_store_a_host_says_that_the_bytes_are_elsewhere(tmp_path: Path, stl: bytes) -> None:
    with hosts(tmp_path, "") as (one, two):
        upload = begun(one, len(stl), filename="skin.stl")
        assert send(one, upload, 0, stl[:100]).status_code == 204
        answer = send(two, upload, 100, stl[100:])
        assert code_of(answer) == (409, "upload.elsewhere")
        assert answer.json()["retryable"], "the next one may reach the right host"
        assert send(one, upload, 100, stl[100:]).status_code == 204
        assert code_of(two.client.post(f"{upload}/mesh")) == (409, "upload.elsewhere")
        assert one.client.post(f"{upload}/mesh").json()["sha256"] == hashlib.sha256(stl).hexdigest()
