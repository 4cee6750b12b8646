"""Blobs in a folder: what only files on a disk can do."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from core.errors import LimitError
from store.blobs import Blob
from store.local_blobs import LocalBlobs


@pytest.fixture
def blobs(tmp_path: Path) -> LocalBlobs:
    """An empty store."""
    return LocalBlobs(tmp_path / "blobs")


def test_stored_files_cannot_be_written(blobs: LocalBlobs) -> None:
    blob = blobs.put_bytes(b"x")
    assert blobs.path(blob.sha256).stat().st_mode & 0o777 == 0o440


def test_a_full_disk_is_a_limit_and_leaves_nothing(blobs: LocalBlobs) -> None:
    if not Path("/dev/full").exists():
        pytest.fail("the kernel has no /dev/full")

    class Full(LocalBlobs):
        def _place(self, temporary: Path, blob: Blob) -> None:
            with Path("/dev/full").open("wb", buffering=0) as full:
                full.write(b"x")

    broken = Full(blobs.path("0" * 64).parents[2])
    with pytest.raises(LimitError) as caught:
        broken.put_bytes(b"abc")
    assert (caught.value.code, caught.value.facts) == ("storage.full", {"written_bytes": 3})
    assert isinstance(caught.value.__cause__, OSError)
    assert caught.value.__cause__.errno == errno.ENOSPC
    assert [path for path in broken.path("0" * 64).parents[2].rglob("*") if path.is_file() and path.name != ".lock"] == []


def test_a_blob_cut_short_by_the_file_system_is_put_right(blobs: LocalBlobs) -> None:
    blob = blobs.put_bytes(b"0123456789")
    place = blobs.path(blob.sha256)
    place.chmod(0o600)
    place.write_bytes(b"")  # what a power cut on a careless file system leaves
    assert blobs.put_bytes(b"0123456789") == blob
    assert place.read_bytes() == b"0123456789"


def test_the_sweep_spares_the_young_and_the_referenced(blobs: LocalBlobs) -> None:
    kept, orphan, young = (blobs.put_bytes(text) for text in (b"kept", b"orphan", b"young"))
    old = time.time() - 7200
    for blob in (kept, orphan):
        os.utime(blobs.path(blob.sha256), (old, old))
    assert blobs.sweep({kept.sha256}, older_than_s=3600.0) == [orphan]
    assert {blob.sha256 for blob in blobs.all()} == {kept.sha256, young.sha256}


@pytest.mark.parametrize("refresh", ["put", "touch"])
def test_a_blob_wanted_again_is_young_again(blobs: LocalBlobs, refresh: str) -> None:
    blob = blobs.put_bytes(b"again")
    old = time.time() - 7200
    os.utime(blobs.path(blob.sha256), (old, old))
    if refresh == "put":
        blobs.put_bytes(b"again")
    else:
        assert blobs.touch(blob.sha256)
    assert blobs.sweep(frozenset(), older_than_s=3600.0) == []


def test_a_sweep_clears_remains_of_interrupted_writes(blobs: LocalBlobs) -> None:
    incoming = blobs.path("0" * 64).parents[2] / ".incoming"
    (incoming / "remains").write_bytes(b"half")
    assert blobs.sweep(frozenset(), older_than_s=3600.0) == []
    assert (incoming / "remains").exists()
    blobs.sweep(frozenset(), older_than_s=-1.0)
    assert list(incoming.iterdir()) == []


@pytest.mark.parametrize("cut_short", [False, True])
def test_a_sweep_never_takes_what_is_put_again_meanwhile(blobs: LocalBlobs, cut_short: bool) -> None:
    """The blob is old and nobody's when the sweep looks at it; just then somebody stores the same bytes."""
    blob = blobs.put_bytes(b"the same")
    place = blobs.path(blob.sha256)
    if cut_short:
        place.chmod(0o600)
        place.write_bytes(b"")
    old = time.time() - 7200
    os.utime(place, (old, old))
    writer = threading.Thread(target=blobs.put_bytes, args=(b"the same",))

    class Nobodys:
        def __contains__(self, sha256: object) -> bool:
            writer.start()
            writer.join(timeout=0.3)
            assert writer.is_alive()  # waits until the sweep has made up its mind
            return False

    assert [swept.sha256 for swept in blobs.sweep(Nobodys(), older_than_s=3600.0)] == [blob.sha256]
    writer.join()
    assert place.read_bytes() == b"the same"


def test_killed_at_any_line_a_writer_leaves_no_half_blob(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "tests.store.killed_writer", str(tmp_path)], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    killed, whole = (int(word) for word in done.stdout.split())
    assert killed >= 20  # lines at which it was killed
    assert whole >= 3  # of them after the renaming
