"""`admin gc`: what nobody needs goes, what somebody needs stays, on a folder and in an object store."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import update

from server.admin.command import admin
from store.audit import Audit, AuditEntry
from store.blobs import Blobs
from store.database import Database
from store.job import MeshInput
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.open_blobs import open_blobs
from store.records import UploadRow
from store.s3_blobs import S3Blobs
from store.s3_place import S3Place
from store.settings import Settings
from store.uploads import Uploads
from store.workspace import DEFAULT_WORKSPACE
from tests.seaweed import SeaweedServer

Run = Callable[..., Any]
LONG_AGO = time.time() - 30 * 86_400

pytestmark = pytest.mark.usefixtures("bare_environment")


@pytest.fixture
def settings() -> Settings:
    return Settings()


@pytest.fixture
def db(settings: Settings) -> Iterator[Database]:
    database = Database(settings)
    database.migrate()
    yield database
    database.close()


@pytest.fixture
def blobs(settings: Settings, db: Database) -> Blobs:
    return open_blobs(settings, db)


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Run:
    """gc with --json; the heaps by their kind."""

    def run(*words: str) -> dict[str, tuple[int, int | None]]:
        capsys.readouterr()
        assert admin(["--json", "gc", *words]) == 0, capsys.readouterr().err
        return {heap["kind"]: (heap["count"], heap["bytes"]) for heap in json.loads(capsys.readouterr().out)}

    return run


def old(path: Path) -> Path:
    for inside in (path, *path.rglob("*")):
        os.utime(inside, (LONG_AGO, LONG_AGO))
    return path


def test_what_is_left_behind_is_counted_then_removed(
    settings: Settings, db: Database, blobs: LocalBlobs, run: Run, tmp_path: Path
) -> None:
    jobs = Jobs(db)
    wanted, orphan, young = (blobs.put_bytes(content) for content in (b"wanted", b"orphan", b"young"))
    job = jobs.create(DEFAULT_WORKSPACE, "heal", {}, mesh_inputs=[MeshInput("/x", "x", wanted.sha256, "model/stl", "x.stl")])
    claimed = jobs.claim(job.id, 1, "me", 600)
    assert claimed is not None
    for blob in (wanted, orphan):
        old(blobs.path(blob.sha256))
    scratch = settings.scratch_dir / "jobs"
    for name in (f"{job.id}.{claimed.lease_token}", "gone.1"):
        (scratch / name).mkdir(parents=True)
        (scratch / name / "half").write_bytes(b"1234567")
        old(scratch / name)
    broken = settings.data_dir / "incoming" / "request"
    broken.mkdir(parents=True)
    (broken / "body").write_bytes(b"12345")
    old(broken)
    uploads = Uploads(db)
    kept, given_up = (uploads.create(DEFAULT_WORKSPACE, file_name="a", fields={}, length=9) for _ in range(2))
    with db.session() as session:
        past = db.now(session) - timedelta(hours=1)
        session.execute(update(UploadRow).where(UploadRow.id == given_up.id).values(expires_at=past))
    pieces = settings.data_dir / "uploads"
    pieces.mkdir()
    for name in (kept.id, given_up.id, "nobody's"):
        (pieces / name).write_bytes(b"123")
    with db.session() as session:
        long_ago = db.now(session) - timedelta(days=400)
    Audit(db).write([AuditEntry(long_ago, "admin", None, None, "x", "y", "done")])

    found = run("--dry-run")
    assert found["files no row names"] == (1, 6)
    assert found["folders of ended attempts"] == (1, 7)
    assert found["folders of broken requests"] == (1, 5)
    assert found["pieces of forgotten uploads"] == (1, 3)  # that of the other has its row still
    assert (found["rows of uploads"], found["rows of audit"]) == ((1, None), (1, None))
    assert run("--dry-run")["files no row names"] == found["files no row names"], "looking changes nothing"

    removed = run("--yes")
    assert removed["files no row names"] == (1, 6)
    assert removed["pieces of forgotten uploads"] == (2, 6)
    assert {blob.sha256 for blob in blobs.all()} == {wanted.sha256, young.sha256}
    assert [path.name for path in scratch.iterdir()] == [f"{job.id}.{claimed.lease_token}"]
    assert [path.name for path in pieces.iterdir()] == [kept.id]
    assert list((settings.data_dir / "incoming").iterdir()) == []
    again = run("--dry-run")
    assert {kind for kind, (count, _) in again.items() if count} <= {"write-ahead log"}


def test_the_file_is_rewritten_on_request(run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert "shrunk by rewriting" in run("--yes", "--rewrite")
    assert admin(["gc"]) == 2
    assert "admin.not_confirmed" in capsys.readouterr().err


def test_parts_of_killed_writers_go_from_the_object_store(
    seaweed: SeaweedServer, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = seaweed.new_bucket()
    place = S3Place.of(url)
    settings = Settings(data_dir=tmp_path / "data", blobs_url=url)
    db = Database(settings)
    blobs = open_blobs(settings, db)
    assert isinstance(blobs, S3Blobs)
    client = seaweed.client()
    begun = client.create_multipart_upload(Bucket=place.bucket, Key="ab/cd/" + "ab" * 32)
    client.upload_part(Bucket=place.bucket, Key=begun["Key"], UploadId=begun["UploadId"], PartNumber=1, Body=b"half")
    blob = blobs.put_bytes(b"orphan")
    assert blobs.sweep(frozenset(), 3600.0) == []
    assert len(client.list_multipart_uploads(Bucket=place.bucket)["Uploads"]) == 1
    time.sleep(1.1)  # the store knows whole seconds
    assert blobs.orphans(frozenset(), 0.0) == [blob]
    assert blobs.sweep(frozenset(), 0.0) == [blob]
    assert len(client.list_multipart_uploads(Bucket=place.bucket)["Uploads"]) == 1, "it may be a large file on a slow line"
    monkeypatch.setattr("store.s3_blobs.PARTS_S", 0.0)
    blobs.sweep(frozenset(), 0.0)
    assert client.list_multipart_uploads(Bucket=place.bucket).get("Uploads", []) == []
    db.close()
