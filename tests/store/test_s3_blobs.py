"""Blobs in an object store: what only a store at the other end of a wire can do."""

from __future__ import annotations

import threading
import time
import urllib.request
from pathlib import Path

import pytest

from core.errors import InternalError
from store.database import Database
from store.s3_blobs import PART_BYTES, S3Blobs
from store.s3_place import S3Place
from store.sweep_lock import DatabaseLock, FileLock, SweepLock
from tests.seaweed import SeaweedServer


@pytest.fixture(scope="module")
def place(seaweed: SeaweedServer) -> S3Place:
    """An empty bucket."""
    return S3Place.of(seaweed.new_bucket())


@pytest.fixture
def blobs(place: S3Place, tmp_path: Path) -> S3Blobs:
    """A store with links that hold for a minute."""
    return S3Blobs(place, FileLock(tmp_path / "lock"), links_s=60.0)


def test_a_file_of_several_parts_arrives_whole(blobs: S3Blobs, tmp_path: Path) -> None:
    source = tmp_path / "large"
    source.write_bytes(b"0123456789abcdef" * (PART_BYTES // 16) + b"the rest")
    blob = blobs.put_file(source)
    folder = tmp_path / "in"
    folder.mkdir()
    assert blobs.fetch(blob.sha256, folder).read_bytes() == source.read_bytes()
    assert blobs.delete(blob.sha256)


def test_a_link_serves_the_bytes_without_a_key(blobs: S3Blobs) -> None:
    link = blobs.link(blobs.put_bytes(b"for you").sha256, 'attachment; filename="skin.stl"', "model/stl")
    assert link is not None
    with urllib.request.urlopen(link) as answer:
        assert answer.read() == b"for you"
        assert answer.headers["Content-Disposition"] == 'attachment; filename="skin.stl"'
        assert answer.headers["Content-Type"] == "model/stl"


def test_other_bytes_under_a_name_are_noticed(blobs: S3Blobs, place: S3Place, seaweed: SeaweedServer, tmp_path: Path) -> None:
    sha256 = blobs.put_bytes(b"true").sha256
    key = f"{sha256[:2]}/{sha256[2:4]}/{sha256}"
    seaweed.client().put_object(Bucket=place.bucket, Key=key, Body=b"fals")
    with pytest.raises(InternalError) as caught:
        blobs.fetch(sha256, tmp_path)
    assert caught.value.code == "blob.corrupt"
    assert list(tmp_path.iterdir()) == []


def test_a_touched_blob_is_young_and_forgotten_touches_are_swept(blobs: S3Blobs, place: S3Place, seaweed: SeaweedServer) -> None:
    blob = blobs.put_bytes(b"wanted again")
    time.sleep(2.1)  # the store tells moments to the second
    assert blobs.touch(blob.sha256)
    assert blob not in blobs.sweep(frozenset(), older_than_s=1.5)
    assert blob in blobs.sweep(frozenset(), older_than_s=-5.0)
    listed = seaweed.client().list_objects_v2(Bucket=place.bucket, Prefix="touched/")
    assert listed["KeyCount"] == 0


@pytest.mark.parametrize("kind", ["file", "database"])
def test_a_touch_waits_for_a_sweep_and_then_knows_better(
    kind: str, place: S3Place, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """The sweep has judged the blob and is about to delete it; a touch at that moment must not report it kept."""
    if kind == "file":
        lock: SweepLock = FileLock(tmp_path / "lock")
    else:
        database = Database(request.getfixturevalue("postgres_settings"))
        request.addfinalizer(database.close)
        lock = DatabaseLock(database)
    blobs = S3Blobs(place, lock)
    blob = blobs.put_bytes(f"raced {kind}".encode())
    told: list[bool] = []
    toucher = threading.Thread(target=lambda: told.append(blobs.touch(blob.sha256)))
    with lock.held(alone=True):
        toucher.start()
        toucher.join(timeout=0.5)
        assert toucher.is_alive()
        assert blobs.delete(blob.sha256)
    toucher.join()
    assert told == [False]


@pytest.mark.parametrize(("secret", "words"), [("wrong", "refuses"), ("", "has a key without")])
def test_a_wrong_secret_is_an_outage_that_names_no_secret(
    seaweed: SeaweedServer, place: S3Place, tmp_path: Path, secret: str, words: str
) -> None:
    url = seaweed.url(place.bucket, secret=secret)
    if not secret:
        with pytest.raises(ValueError, match=words):
            S3Place.of(url)
        return
    with pytest.raises(InternalError, match=words) as caught:
        S3Blobs(S3Place.of(url), FileLock(tmp_path / "lock")).check()
    assert caught.value.code == "blobs.unavailable"
    assert secret not in str(caught.value)
    assert secret not in repr(S3Place.of(url))


def test_a_store_that_is_away_is_an_outage(tmp_path: Path) -> None:
    blobs = S3Blobs(S3Place.of("s3+http://key:secret@127.0.0.1:1/bucket"), FileLock(tmp_path / "lock"))
    with pytest.raises(InternalError) as caught:
        blobs.put_bytes(b"x")
    assert caught.value.code == "blobs.unavailable"


@pytest.mark.parametrize(
    ("url", "bucket", "prefix", "endpoint"),
    [
        ("s3://lab/meshes", "lab", "meshes/", None),
        ("s3+http://key:a%2Fb@[::1]:8333/lab", "lab", "", "http://[::1]:8333"),
        ("s3+https://key:secret@store.example/lab/a/b/?region=eu-north-1", "lab", "a/b/", "https://store.example"),
    ],
)
def test_a_url_tells_everything(url: str, bucket: str, prefix: str, endpoint: str | None) -> None:
    place = S3Place.of(url)
    assert (place.bucket, place.prefix, place.endpoint) == (bucket, prefix, endpoint)


@pytest.mark.parametrize(
    "url", ["http://host/bucket", "s3+http:///bucket", "s3://ab", "s3+http://key:secret@host", "s3+http://h:x/bucket"]
)
def test_an_unfit_url_is_refused_without_its_secret(url: str) -> None:
    with pytest.raises(ValueError, match="blobs URL") as caught:
        S3Place.of(url)
    assert "secret@" not in str(caught.value)
