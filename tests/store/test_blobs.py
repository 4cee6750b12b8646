"""The contract of all stores of blobs, held by a folder and by a real object store."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path

import pytest
import time_machine

from core.errors import InternalError
from store.blobs import CHUNK_BYTES, Blob, Blobs
from store.local_blobs import LocalBlobs
from store.s3_blobs import S3Blobs
from store.s3_place import S3Place
from store.sweep_lock import FileLock
from tests.seaweed import SeaweedServer


@pytest.fixture(params=["folder", "s3"])
def blobs(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Blobs]:
    """An empty store."""
    if request.param == "folder":
        yield LocalBlobs(tmp_path / "blobs")
        return
    seaweed: SeaweedServer = request.getfixturevalue("seaweed")
    made = S3Blobs(S3Place.of(seaweed.url(request.getfixturevalue("bucket")) + f"/{tmp_path.name}"), FileLock(tmp_path / "lock"))
    yield made
    for blob in list(made.all()):
        made.delete(blob.sha256)


@pytest.fixture(scope="module")
def bucket(seaweed: SeaweedServer) -> str:
    """A bucket for all tests of this module; each has a folder in it."""
    return seaweed.new_bucket().rpartition("/")[2]


@pytest.mark.parametrize("size", [0, 1, CHUNK_BYTES - 1, CHUNK_BYTES, 2 * CHUNK_BYTES + 17])
def test_bytes_and_files_get_the_name_of_their_content(blobs: Blobs, tmp_path: Path, size: int) -> None:
    data = bytes(number % 251 for number in range(size))
    source = tmp_path / "source"
    source.write_bytes(data)
    expected = Blob(hashlib.sha256(data).hexdigest(), size)
    assert blobs.put_file(source) == expected
    assert blobs.put_bytes(data) == expected
    with source.open("rb") as file:
        file.read(7)
        assert blobs.put_open(file) == expected, "all of it, wherever the file was left"
    with blobs.open(expected.sha256) as stored:
        assert stored.read() == data
    assert list(blobs.all()) == [expected]
    assert source.read_bytes() == data


def test_what_is_not_there_is_missing(blobs: Blobs) -> None:
    absent = "0" * 64
    with pytest.raises(InternalError) as caught:
        blobs.open(absent)
    assert caught.value.code == "blob.missing"
    assert blobs.touch(absent) is False
    assert blobs.delete(absent) is False


@pytest.mark.parametrize("name", ["", "../../etc/passwd", "A" * 64, "0" * 63, "0" * 64 + "\n"])
def test_only_a_digest_is_a_name(blobs: Blobs, name: str) -> None:
    with pytest.raises(InternalError) as caught:
        blobs.open(name)
    assert caught.value.code == "blob.bad_digest"


def test_links_pipes_and_folders_are_not_files(blobs: Blobs, tmp_path: Path) -> None:
    target, link, pipe = tmp_path / "target", tmp_path / "link", tmp_path / "pipe"
    target.write_bytes(b"secret")
    link.symlink_to(target)
    os.mkfifo(pipe)
    for path in (link, pipe, tmp_path):
        with pytest.raises(InternalError) as caught:
            blobs.put_file(path)
        assert caught.value.code == "blob.not_a_file"
    with pytest.raises(FileNotFoundError):
        blobs.put_file(tmp_path / "absent")
    assert list(blobs.all()) == []


def test_a_span_of_the_bytes_can_be_read(blobs: Blobs) -> None:
    data = bytes(number % 251 for number in range(CHUNK_BYTES + 1000))
    sha256 = blobs.put_bytes(data).sha256
    for start, stop in ((0, len(data)), (17, 18), (CHUNK_BYTES - 1, CHUNK_BYTES + 1), (5, 5)):
        assert b"".join(blobs.read(sha256, start, stop)) == data[start:stop]
    with pytest.raises(InternalError) as caught:
        list(blobs.read("0" * 64, 0, 1))
    assert caught.value.code == "blob.missing"


def test_a_child_gets_a_local_file(blobs: Blobs, tmp_path: Path) -> None:
    blob = blobs.put_bytes(b"solid")
    assert blobs.fetch(blob.sha256, tmp_path).read_bytes() == b"solid"
    with pytest.raises(InternalError) as caught:
        blobs.fetch("0" * 64, tmp_path)
    assert caught.value.code == "blob.missing"


def test_what_is_deleted_is_gone(blobs: Blobs) -> None:
    blob = blobs.put_bytes(b"gone")
    assert blobs.delete(blob.sha256)
    assert not blobs.touch(blob.sha256)
    assert list(blobs.all()) == []


def test_the_sweep_spares_the_young_and_the_referenced(blobs: Blobs) -> None:
    kept, orphan = blobs.put_bytes(b"kept"), blobs.put_bytes(b"orphan")
    assert blobs.sweep(frozenset(), older_than_s=3600.0) == []
    assert blobs.sweep({kept.sha256}, older_than_s=-5.0) == [orphan]
    assert list(blobs.all()) == [kept]


def test_the_sweep_goes_by_the_clock_of_the_store(blobs: Blobs) -> None:
    young = blobs.put_bytes(b"young")
    with time_machine.travel(timedelta(minutes=10), tick=True):
        assert blobs.orphans(frozenset(), older_than_s=300.0) == []
        assert blobs.sweep(frozenset(), older_than_s=300.0) == []
    assert list(blobs.all()) == [young]


def test_a_store_that_works_says_so(blobs: Blobs) -> None:
    blobs.check()
    assert list(blobs.all()) == []
