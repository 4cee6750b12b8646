"""`integument admin retention`, `backup`, `backups`, `restore` as an operator types them."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import update

from server.admin.command import admin
from server.data_folder import DataFolder
from store.audit import Audit
from store.database import Database
from store.job import JobOutput
from store.jobs import Jobs
from store.open_blobs import open_blobs
from store.records import JobRow
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.server.conftest import Run
from tests.store.samples import CRASHED, claimed

pytestmark = pytest.mark.usefixtures("bare_environment")


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """A command that is at fault; what it said."""

    def refused(*words: str) -> str:
        capsys.readouterr()
        assert admin(list(words)) == 2
        return capsys.readouterr().err

    return refused


def failed_job(days_ago: float) -> str:
    db = Database(Settings())
    db.migrate()
    job = claimed(Jobs(db))
    Jobs(db).fail(job.id, job.lease_token, CRASHED)
    with db.session() as session:
        ended = db.now(session) - timedelta(days=days_ago)
        session.execute(update(JobRow).where(JobRow.id == job.id).values(finished_at=ended))
    db.close()
    return job.id


def ids(run: Run) -> set[str]:
    return {job["id"] for job in run("jobs", "list")}


def test_days_are_set_shown_and_kept(run: Run, refused: Callable[..., str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INTEGUMENT_KEEP_JOBS_DAYS", "90")
    old, young = failed_job(50), failed_job(1)
    run("workspaces", "create", "lab")
    assert [line["jobs_days"] for line in run("retention", "show")] == [90, 90]
    assert run("retention", "set", "--jobs-days", "30", "--events-days", "0")["own"] == ["jobs", "events"]
    assert [(line["workspace"], line["jobs_days"]) for line in run("retention", "show")] == [("default", 30), ("lab", 90)]
    counted = run("retention", "run", "--dry-run")
    assert [(line["workspace"], line["jobs"]) for line in counted] == [("default", 1), ("lab", 0)]
    assert "admin.not_confirmed" in refused("retention", "run")
    assert ids(run) == {old, young}
    assert run("retention", "run", "--yes")[0]["jobs"] == 1
    assert ids(run) == {young}
    assert run("retention", "set", "--jobs-days", "server")["jobs_days"] == 90
    assert "admin.nothing_selected" in refused("retention", "set")
    assert "workspace.not_found" in refused("retention", "set", "--workspace", "nowhere", "--jobs-days", "1")
    assert "--jobs-days" in refused("retention", "set", "--jobs-days", "-1")


def test_a_copy_is_made_listed_and_brought_back(run: Run, refused: Callable[..., str], tmp_path: Path) -> None:
    vault, job = str(tmp_path / "vault"), failed_job(0)
    assert "backup.not_found" in refused("restore", vault, "--yes")
    first = run("backup", vault)
    assert (first["missing"], first["corrupt"], first["removed"]) == (0, 0, [])
    second = run("backup", vault, "--keep", "1")
    assert second["removed"] == [first["name"]]
    (listed,) = run("backups", vault, "--verify")
    assert (listed["name"], listed["whole"]) == (second["name"], True)
    assert "restore.not_empty" in refused("restore", vault, "--yes")
    shutil.rmtree(tmp_path / "data")
    assert "admin.not_confirmed" in refused("restore", vault)
    assert "backup.not_found" in refused("restore", vault, "--yes", "--name", first["name"])
    assert run("restore", vault, "--yes")["name"] == second["name"]
    assert ids(run) == {job}
    db = Database(Settings())
    assert "restore" in [entry.action for entry in Audit(db).list()]
    db.close()


def test_lost_files_are_told_by_the_exit_code(run: Run, tmp_path: Path) -> None:
    vault = str(tmp_path / "vault")
    failed_job(0)
    db = Database(Settings())
    blobs, jobs = open_blobs(Settings(), db), Jobs(db)
    blob = blobs.put_bytes(b"log")
    job = claimed(jobs)
    output = JobOutput(blob.sha256, blob.size, "text/plain", "log.txt")
    jobs.finish(job.id, job.lease_token, verdict="not_ready", summary="", outputs={"log": output}, timings_s={})
    run("backup", vault)
    blobs.delete(blob.sha256)
    assert run("restore", vault, "--files-only") == {"name": run("backups", vault)[0]["name"], "files_put": 1}
    blobs.delete(blob.sha256)
    shutil.rmtree(tmp_path / "vault")
    assert run("backup", vault, code=1)["missing"] == 1
    assert jobs.get(DEFAULT_WORKSPACE, job.id).outputs
    db.close()


def test_a_server_that_runs_is_not_restored_into(refused: Callable[..., str], run: Run, tmp_path: Path) -> None:
    vault = str(tmp_path / "vault")
    failed_job(0)
    run("backup", vault)
    shutil.rmtree(tmp_path / "data")
    folder = DataFolder(tmp_path / "data")
    try:
        assert "server.already_running" in refused("restore", vault, "--yes")
    finally:
        folder.release()
    assert ids(run) == set()
