"""Backups made of real databases and restored into others: same rows, same files, nothing half."""

from __future__ import annotations

import gzip
import json
import shutil
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import text

from core.errors import InputError, IntegumentError, InternalError, StateError
from store.api_keys import ApiKeys
from store.backup.dump import dump_tables
from store.backup.load import FENCE
from store.backup.make import Backup, BackupReport, verify
from store.backup.restore import Restore
from store.backup.tables import EXPENDABLE
from store.backup.vault import MANIFEST, Vault
from store.blobs import Blobs
from store.callback import Subscriber
from store.database import Database
from store.idempotency import IdempotencyKeys, Reply
from store.job import Job, JobOutput, JobStatus, MeshInput
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.open_blobs import open_blobs
from store.references import References
from store.scope import Scope
from store.settings import Settings
from store.uploads import Uploads
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces
from tests.postgres import PostgresServer
from tests.seaweed import SeaweedServer

Open = Callable[..., tuple[Database, Blobs]]


@pytest.fixture
def place(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Open]:
    """Opens an empty database and its blobs, of either kind."""
    opened: list[Database] = []

    def open_place(kind: str = "sqlite", *, migrate: bool = True) -> tuple[Database, Blobs]:
        given: dict[str, Any] = {"data_dir": tmp_path / f"place-{len(opened)}"}
        if "postgresql" in kind:
            server: PostgresServer = request.getfixturevalue("postgres")
            given["database_url"] = server.new_database()
        if "s3" in kind:
            store: SeaweedServer = request.getfixturevalue("seaweed")
            given["blobs_url"] = store.new_bucket()
        settings = Settings(**given)
        db = Database(settings)
        opened.append(db)
        if migrate:
            db.migrate()
        return db, open_blobs(settings, db)

    yield open_place
    for db in opened:
        db.close()


@pytest.fixture
def vault(tmp_path: Path) -> Vault:
    return Vault(tmp_path / "vault")


def make(place: tuple[Database, Blobs], vault: Vault) -> BackupReport:
    return Backup(*place, vault, "1.2.3").make()


def restore(place: tuple[Database, Blobs], vault: Vault, name: str | None = None) -> int:
    return Restore(*place, vault).restore(name or vault.names()[0]).queued_again


def finished(db: Database, blobs: Blobs, content: bytes, workspace: WorkspaceId = DEFAULT_WORKSPACE) -> Job:
    """A job that read and wrote these bytes."""
    jobs, blob = Jobs(db), blobs.put_bytes(content)
    given = MeshInput("/v1/meshes/1", "skin", blob.sha256, "model/stl", "skin.stl")
    job = jobs.create(
        workspace,
        "shells",
        {"z": 1, "a": [0.1, None, "ä\u2028"]},  # the order of keys is the user's
        mesh_inputs=[given],
        subscriber=Subscriber("http://here", "https://there/s", "https://there/p"),
    )
    claimed = jobs.claim(job.id, 1, "worker", 30)
    assert claimed is not None
    jobs.append_events(job.id, claimed.lease_token, [("log", {"message": "half"})])
    made = blobs.put_bytes(content * 2)
    outputs = {"package": JobOutput(made.sha256, made.size, "application/zip", "package.zip")}
    assert jobs.finish(job.id, claimed.lease_token, verdict="simulation_ready", summary="", outputs=outputs, timings_s={"a": 0.1})
    return jobs.get(workspace, job.id)


def contents(db: Database, folder: Path) -> dict[str, list[dict[str, Any]]]:
    """Every row of every table."""
    folder.mkdir()
    with db.snapshot() as session:
        files = dump_tables(session, folder)
    return {
        name: sorted(map(json.loads, gzip.decompress((folder / file.file).read_bytes()).splitlines()), key=json.dumps)
        for name, file in files.items()
        if name not in EXPENDABLE
    }


def without(rows: dict[str, list[dict[str, Any]]], *columns: str) -> dict[str, list[dict[str, Any]]]:
    return {name: [{key: row[key] for key in row if key not in columns} for row in table] for name, table in rows.items()}


@pytest.mark.parametrize(
    ("source", "target"),
    [("sqlite", "sqlite"), ("sqlite", "postgresql s3"), ("postgresql s3", "postgresql s3"), ("postgresql", "sqlite")],
)
def test_every_row_and_file_comes_back(source: str, target: str, place: Open, vault: Vault, tmp_path: Path) -> None:
    db, blobs = here = place(source)
    Workspaces(db).create("lab", quota_bytes=7 * 1024**4)
    key = ApiKeys(db).create(WorkspaceId("lab"), "Ada", [Scope.READ])
    with db.session() as session:
        IdempotencyKeys(db).keep(DEFAULT_WORKSPACE, "monday", "f" * 64, Reply(201, {}, {"job": None}), session)
    jobs = [finished(db, blobs, f"{number}".encode(), WorkspaceId("lab")) for number in range(3)]
    report = make(here, vault)
    assert (report.manifest.blobs.count, report.copied, report.manifest.missing) == (6, 6, ())
    there, kept = elsewhere = place(target)
    assert restore(elsewhere, vault) == 0
    before, after = contents(db, tmp_path / "before"), contents(there, tmp_path / "after")
    assert without(after, "lease_token", "lease_until") == without(before, "lease_token", "lease_until")
    assert {row["lease_token"] for row in after["jobs"]} == {1 + FENCE}
    for job in jobs:
        assert Jobs(there).get(job.workspace, job.id).inputs == job.inputs
        assert list(Jobs(there).get(job.workspace, job.id).inputs) == ["z", "a"]
    assert ApiKeys(there).authenticate(key.text).name == "Ada"
    for blob in blobs.all():
        with blobs.open(blob.sha256) as one, kept.open(blob.sha256) as other:
            assert one.read() == other.read()
    assert {blob.sha256 for blob in kept.all()} == {blob.sha256 for blob in blobs.all()}


def test_a_backup_of_the_same_rows_has_the_same_bytes(place: Open, vault: Vault) -> None:
    db, blobs = here = place()
    finished(db, blobs, b"one")
    one, two = make(here, vault), make(here, vault)
    assert one.manifest.tables == two.manifest.tables
    assert one.manifest.blobs == two.manifest.blobs


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_what_was_running_is_queued_again_and_its_old_worker_writes_nothing(kind: str, place: Open, vault: Vault) -> None:
    db, _ = here = place(kind)
    jobs = Jobs(db)
    running, dismissed, waiting = (jobs.create(DEFAULT_WORKSPACE, "heal", {}) for _ in range(3))
    tokens = {job.id: claimed.lease_token for job in (running, dismissed) if (claimed := jobs.claim(job.id, 1, "old", 600))}
    jobs.mark_all_rung([(waiting.id, 1)])
    jobs.dismiss(DEFAULT_WORKSPACE, dismissed.id)
    Uploads(db).create(DEFAULT_WORKSPACE, file_name="half.stl", fields={}, length=10)
    make(here, vault)
    # the lost world goes on: another worker claims the job twice more
    for _ in range(2):
        jobs.expire_all_leases()
        jobs.claim(running.id, 2, "old", 600)

    there, _ = elsewhere = place(kind)
    assert restore(elsewhere, vault) == 2
    jobs = Jobs(there)
    again = jobs.get(DEFAULT_WORKSPACE, running.id)
    assert (again.status, again.attempt, again.lease_owner) == (JobStatus.ACCEPTED, 1, None)
    assert jobs.get(DEFAULT_WORKSPACE, dismissed.id).status is JobStatus.DISMISSED
    assert {job_id for job_id, _ in jobs.due_to_ring(3600)} == {running.id, waiting.id}
    claimed = jobs.claim(running.id, 1, "new", 600)
    assert claimed is not None
    for token in range(tokens[running.id], tokens[running.id] + 5):
        assert not jobs.renew(running.id, token, 600).kept
    assert jobs.renew(running.id, claimed.lease_token, 600).kept
    assert Uploads(there).known() == frozenset()


def test_only_what_is_new_is_copied_and_old_ones_go(place: Open, vault: Vault) -> None:
    db, blobs = here = place()
    job = finished(db, blobs, b"one")
    first = make(here, vault)
    Jobs(db).dismiss(DEFAULT_WORKSPACE, job.id)
    finished(db, blobs, b"two")
    second = make(here, vault)
    assert (second.manifest.blobs.count, second.copied, second.copied_bytes) == (2, 2, 9)
    assert make(here, vault).copied == 0
    assert len(list(vault.pool.all())) == 4
    with vault.alone():
        assert list(vault.keep(2)) == [first.name]
    assert len(list(vault.pool.all())) == 2
    assert all(verify(vault, name, print) for name in vault.names())


def test_nobody_else_can_read_it(place: Open, vault: Vault) -> None:
    db, blobs = here = place()
    finished(db, blobs, b"one")
    make(here, vault)
    assert [path for path in vault.folder.rglob("*") if path.is_file() and path.stat().st_mode & 0o007] == []
    assert [path for path in (vault.folder, *vault.folder.iterdir()) if path.stat().st_mode & 0o077] == []


def test_a_half_written_backup_is_none(place: Open, vault: Vault, monkeypatch: pytest.MonkeyPatch) -> None:
    db, blobs = here = place()
    finished(db, blobs, b"one")

    def break_off(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as broken:
        broken.setattr("store.backup.vault.sync_folder", break_off)
        with pytest.raises(IntegumentError) as caught:
            make(here, vault)
    assert caught.value.code == "storage.full"
    assert list(vault.names()) == []
    (vault.folder / ".draft-2026-01-01T000000Z").mkdir()  # of a writer that was killed
    make(here, vault)
    assert list(vault.folder.glob(".draft*")) == []


def test_one_writer_at_a_time(place: Open, vault: Vault) -> None:
    here = place()
    with vault.alone(), pytest.raises(StateError, match="another backup"):
        make(here, vault)


def test_files_that_are_lost_are_said(place: Open, vault: Vault) -> None:
    db, blobs = here = place()
    assert isinstance(blobs, LocalBlobs)
    job, rotten = finished(db, blobs, b"one"), finished(db, blobs, b"two")
    blobs.delete(job.outputs["package"].sha256)
    path = blobs.path(rotten.outputs["package"].sha256)
    path.chmod(0o600)
    path.write_bytes(b"rotten")
    report = make(here, vault)
    assert report.manifest.missing == (job.outputs["package"].sha256,)
    assert report.manifest.corrupt == (rotten.outputs["package"].sha256,)
    assert verify(vault, report.name, print)
    restore(place(), vault)


def test_files_come_back_beside_a_running_service(place: Open, vault: Vault) -> None:
    db, blobs = here = place()
    assert isinstance(blobs, LocalBlobs)
    job = finished(db, blobs, b"one")
    name = make(here, vault).name
    blobs.delete(job.mesh_inputs["/v1/meshes/1"].sha256)
    path = blobs.path(job.outputs["package"].sha256)
    path.chmod(0o600)
    path.write_bytes(b"rotten")
    assert Restore(*here, vault).put_files(vault.blob_names(name)) == 2
    assert path.read_bytes() == b"oneone"


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_only_an_empty_place_takes_a_backup(kind: str, place: Open, vault: Vault) -> None:
    db, blobs = here = place(kind)
    finished(db, blobs, b"one")
    make(here, vault)
    with pytest.raises(StateError) as caught:
        restore(here, vault)
    assert caught.value.code == "restore.not_empty"
    _, kept = elsewhere = place(kind)
    kept.put_bytes(b"one")  # of a restore that broke off
    restore(elsewhere, vault)
    with pytest.raises(StateError):
        restore(elsewhere, vault)


def test_what_is_not_as_written_is_refused_and_nothing_comes_back(place: Open, vault: Vault, tmp_path: Path) -> None:
    db, blobs = here = place()
    job = finished(db, blobs, b"one")
    name = make(here, vault).name
    good = tmp_path / "good"
    shutil.copytree(vault.folder, good)

    def spoil(path: Path) -> None:
        path.chmod(0o600)
        path.write_bytes(path.read_bytes()[:-1] + b"x")

    there, _ = elsewhere = place()
    for path in (
        vault.folder / name / MANIFEST,
        vault.folder / name / "jobs.jsonl.gz",
        vault.folder / name / "blobs.txt",
        vault.pool.path(job.outputs["package"].sha256),
    ):
        spoil(path)
        told: list[str] = []
        assert not verify(vault, name, told.append)
        assert told
        with pytest.raises(InternalError) as caught:
            restore(elsewhere, vault)
        assert caught.value.code == "backup.corrupt"
        assert Jobs(there).list(DEFAULT_WORKSPACE).items == ()
        shutil.rmtree(vault.folder)
        shutil.copytree(good, vault.folder)
    restore(elsewhere, vault)


def test_a_backup_of_an_older_version_is_brought_up_and_one_of_a_newer_refused(
    place: Open, vault: Vault, monkeypatch: pytest.MonkeyPatch
) -> None:
    db, blobs = here = place("sqlite", migrate=False)
    db.migrate("v0005")
    blob = blobs.put_bytes(b"old")
    with db.session() as session:
        session.execute(
            text(
                "INSERT INTO meshes (id, workspace, name, file_name, unit, format, size_bytes, sha256, canonical_sha256,"
                " vertices, faces, extents_mm, findings, created_at) VALUES ('m', 'default', 'n', 'n.stl', 'mm', 'stl', 3,"
                " :sha, :sha, 4, 4, '[1.0, 1.0, 1.0]', '[]', '2026-01-02 03:04:05.000000')"
            ),
            {"sha": blob.sha256},
        )
    with monkeypatch.context() as older:  # it knew no other tables
        older.setattr(References, "seen_by", lambda _, session: frozenset(session.scalars(text("SELECT sha256 FROM meshes"))))
        name = make(here, vault).name
    there, kept = elsewhere = place("postgresql")
    restore(elsewhere, vault)
    assert there.is_migrated()
    with kept.open(blob.sha256) as file:
        assert file.read() == b"old"
    manifest = vault.folder / name / MANIFEST
    manifest.write_text(manifest.read_text().replace("v0005", "v9999"))
    with pytest.raises(InputError) as caught:
        restore(place(), vault)
    assert caught.value.code == "backup.too_new"


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_beside_writers_every_backup_is_whole(kind: str, place: Open, vault: Vault) -> None:
    """Jobs come, end and are removed with their files at once, while backups are made."""
    db, blobs = here = place(kind)
    stop, failures = threading.Event(), []

    def churn() -> None:
        number, kept = 0, []
        try:
            while not stop.is_set():
                kept.append(finished(db, blobs, f"{threading.get_ident()} {number}".encode()))
                number += 1
                if len(kept) > 5:
                    Jobs(db).dismiss(DEFAULT_WORKSPACE, kept.pop(0).id)
                    blobs.sweep(References(db).all(), 2.0)
        except Exception as error:  # noqa: BLE001 - told by the test
            failures.append(error)

    writers = [threading.Thread(target=churn) for _ in range(2)]
    for writer in writers:
        writer.start()
    reports = []
    try:
        while len(reports) < 4:
            reports.append(make(here, vault))
    finally:
        stop.set()
        for writer in writers:
            writer.join()
    assert failures == []
    assert all(report.manifest.missing == report.manifest.corrupt == () for report in reports)
    assert all(verify(vault, report.name, print) for report in reports)
    there, kept = elsewhere = place("sqlite")
    restore(elsewhere, vault)
    assert References(there).all() == {blob.sha256 for blob in kept.all()}
