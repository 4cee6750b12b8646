"""Who works in one workspace sees and changes nothing of another, on both databases."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path

import pytest
from sqlalchemy import text

from core.errors import InputError, InternalError, StateError
from store.blobs import Blobs
from store.callbacks import Callbacks
from store.database import Database
from store.events import Events
from store.idempotency import IdempotencyKeys, Reply
from store.job import JobStatus
from store.jobs import Jobs
from store.mesh_inputs import MeshInputs
from store.meshes import Meshes, MeshUpload
from store.settings import Settings
from store.uploads import Uploads
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId, require_workspace_id
from store.workspaces import Workspaces
from tests.postgres import PostgresServer
from tests.store.samples import PACKAGE, REFUSED, REPORT, claimed, finish

MISSING = "00000000-0000-4000-8000-000000000000"
# of the tables users reach; what works for the server as a whole is named
SYSTEM: dict[type, set[str]] = {
    IdempotencyKeys: {"sweep"},
    Uploads: {"sweep", "known"},
    Callbacks: {"count", "any_due", "claim", "deliver", "bury", "put_off"},  # of the deliverer, which serves all
}


@pytest.fixture
def other(db: Database) -> WorkspaceId:
    """A second workspace."""
    return Workspaces(db).create("lab-b").id


def refusal(act: Callable[[], object]) -> tuple[str, str, dict[str, object]]:
    with pytest.raises((InputError, StateError)) as caught:
        act()
    return caught.value.code, caught.value.message, dict(caught.value.facts)


def like_missing(said: tuple[str, str, dict[str, object]], job_id: str) -> tuple[str, str, dict[str, object]]:
    code, message, facts = said
    return code, message.replace(job_id, MISSING), {name: str(fact).replace(job_id, MISSING) for name, fact in facts.items()}


@pytest.mark.parametrize("table", [Jobs, Meshes, MeshInputs, Events, IdempotencyKeys, Uploads, Callbacks])
def test_no_method_can_be_called_without_a_workspace(table: type) -> None:
    own = {name: method for name, method in vars(table).items() if callable(method) and not name.startswith("_")}
    assert len(own) >= 1
    system = SYSTEM.get(table, set())
    assert system <= own.keys()
    for name in own.keys() - system:
        first = list(inspect.signature(own[name]).parameters.values())[1]
        assert (first.name, first.annotation, first.default) == ("workspace", "WorkspaceId", inspect.Parameter.empty), name


def test_a_foreign_job_is_as_if_it_were_not_there(jobs: Jobs, events: Events, other: WorkspaceId) -> None:
    running = claimed(jobs)
    failed = claimed(jobs)
    jobs.expire_all_leases()
    jobs.claim(failed.id, 2, "w", 30.0)
    before = [jobs.get(DEFAULT_WORKSPACE, job.id) for job in (running, failed)]
    for job in (running, failed):
        for ask in (jobs.get, jobs.dismiss, jobs.retry, jobs.queue_position):
            foreign = refusal(lambda ask=ask, job=job: ask(other, job.id))  # type: ignore[misc]
            missing = refusal(lambda ask=ask: ask(other, MISSING))  # type: ignore[misc]
            assert like_missing(foreign, job.id) == missing
        assert events.after(other, job.id) == []
        assert events.after(DEFAULT_WORKSPACE, job.id) != []
    assert jobs.list(other).items == ()
    assert [jobs.get(DEFAULT_WORKSPACE, job.id) for job in (running, failed)] == before


def test_lists_hold_what_is_ones_own(jobs: Jobs, other: WorkspaceId) -> None:
    mine = [jobs.create(DEFAULT_WORKSPACE, "shells", {}).id for _ in range(3)]
    theirs = [jobs.create(other, "shells", {}).id for _ in range(3)]
    for workspace, made in ((DEFAULT_WORKSPACE, mine), (other, theirs)):
        page = jobs.list(workspace, limit=2)
        rest = jobs.list(workspace, limit=2, cursor=page.next)
        assert {job.id for job in (*page.items, *rest.items)} == set(made)
        assert {job.workspace for job in page.items} == {workspace}
        # a cursor of one workspace leads nowhere else in another
        assert all(job.workspace == other for job in jobs.list(other, cursor=page.next).items)


def test_foreign_meshes_and_results_cannot_be_referred_to(
    db: Database, jobs: Jobs, blobs: Blobs, other: WorkspaceId, tmp_path: Path
) -> None:
    meshes, inputs = Meshes(db, blobs), MeshInputs(db, blobs)
    path = tmp_path / "skin.stl"
    path.write_bytes(b"mesh")
    mesh = meshes.create(DEFAULT_WORKSPACE, MeshUpload(path, path, "skin", "skin.stl", "mm", "stl", 4, 4, (1.0, 1.0, 1.0)))
    job = claimed(jobs)
    assert finish(jobs, job)
    assert inputs.resolve(DEFAULT_WORKSPACE, f"/v1/meshes/{mesh.id}").name == "skin"
    for ask in (meshes.get, meshes.delete):
        foreign = refusal(lambda ask=ask: ask(other, mesh.id))  # type: ignore[misc]
        assert like_missing(foreign, mesh.id) == refusal(lambda ask=ask: ask(other, MISSING))  # type: ignore[misc]
    assert meshes.list(other).items == ()
    for resolve in (inputs.resolve, inputs.resolve_package):
        for href, there in ((f"/v1/meshes/{mesh.id}", mesh.id), (f"/v1/jobs/{job.id}/results/package", job.id)):
            missing = href.replace(there, MISSING)
            foreign = refusal(lambda resolve=resolve, href=href: resolve(other, href))  # type: ignore[misc]
            nothing = refusal(lambda resolve=resolve, missing=missing: resolve(other, missing))  # type: ignore[misc]
            assert like_missing(foreign, there) == nothing
            assert nothing[0] == "reference.not_found"
    assert meshes.get(DEFAULT_WORKSPACE, mesh.id) == mesh


def test_the_same_idempotency_key_is_another_in_each_workspace(db: Database, other: WorkspaceId) -> None:
    keys, reply = IdempotencyKeys(db), Reply(201, {}, {"job": "1"})
    with db.session() as session:
        keys.keep(DEFAULT_WORKSPACE, "k", "f", reply, session)
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") == reply
    assert keys.find(other, "k", "g") is None
    with db.session() as session:
        keys.keep(other, "k", "g", reply, session)
    assert keys.find(other, "k", "g") == reply


def test_sums_of_outputs_follow_the_job(jobs: Jobs, db: Database) -> None:
    def stored_bytes() -> int:
        with db.reading() as session:
            return int(session.execute(text("SELECT output_bytes FROM jobs")).scalar_one())

    job = claimed(jobs)
    assert stored_bytes() == 0
    failed = jobs.fail(job.id, job.lease_token, REFUSED, outputs={"report": REPORT})
    assert failed is not None
    assert stored_bytes() == REPORT.size
    jobs.retry(DEFAULT_WORKSPACE, job.id)
    assert stored_bytes() == 0
    again = jobs.claim(job.id, 2, "w", 30.0)
    assert again is not None
    finish(jobs, again)
    assert stored_bytes() == PACKAGE.size + REPORT.size


def test_workspaces_have_names_of_their_own(db: Database) -> None:
    workspaces = Workspaces(db)
    made = workspaces.create("lab-a", quota_bytes=10, quota_jobs=3)
    assert workspaces.get("lab-a") == made
    assert [workspace.id for workspace in workspaces.list()] == [DEFAULT_WORKSPACE, "lab-a"]
    assert refusal(lambda: workspaces.create("lab-a"))[0] == "workspace.exists"
    assert refusal(lambda: workspaces.get("lab-c"))[0] == "workspace.not_found"


@pytest.mark.parametrize("name", ["", "Lab", "1st", "a b", "a/b", "-a", "a" * 64, "läb", "a\n"])
def test_names_are_plain(name: str) -> None:
    with pytest.raises(InputError):
        require_workspace_id(name)


@pytest.fixture(params=["sqlite", "postgresql"])
def old(request: pytest.FixtureRequest, tmp_path: Path) -> Settings:
    """A database without tables."""
    if request.param == "sqlite":
        return Settings(data_dir=tmp_path)
    server: PostgresServer = request.getfixturevalue("postgres")
    return Settings(data_dir=tmp_path, database_url=server.new_database())


def test_what_was_there_before_belongs_to_the_default_workspace(old: Settings) -> None:
    database = Database(old)
    database.migrate()
    jobs = Jobs(database)
    job = claimed(jobs)
    finish(jobs, job)
    waiting = jobs.create(DEFAULT_WORKSPACE, "validate", {"a": 1})
    keys, reply = IdempotencyKeys(database), Reply(201, {}, {"job": job.id})
    with database.session() as session:
        keys.keep(DEFAULT_WORKSPACE, "k", "f", reply, session)
    before = [jobs.get(DEFAULT_WORKSPACE, one.id) for one in (job, waiting)]
    told = Events(database).after(DEFAULT_WORKSPACE, job.id)
    Workspaces(database).create("lab-b")
    assert keys.find(WorkspaceId("lab-b"), "k", "f") is None

    database.revert("v0002")
    with database.reading() as session:
        columns = session.execute(text("SELECT * FROM jobs")).keys()
        assert "workspace" not in columns
        assert session.execute(text("SELECT count(*) FROM job_outputs")).scalar_one() == 2
        assert session.execute(text("SELECT count(*) FROM job_events")).scalar_one() == len(told) + 1
    database.migrate()

    assert [jobs.get(DEFAULT_WORKSPACE, one.id) for one in (job, waiting)] == before
    assert Events(database).after(DEFAULT_WORKSPACE, job.id) == told
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") == reply
    with database.reading() as session:
        sums = set(session.execute(text("SELECT status, output_bytes FROM jobs")).all())
    assert sums == {(JobStatus.SUCCESSFUL, PACKAGE.size + REPORT.size), (JobStatus.ACCEPTED, 0)}
    (only,) = Workspaces(database).list()
    assert only.id == DEFAULT_WORKSPACE
    assert abs((only.created_at - datetime.now(UTC)).total_seconds()) < 60
    database.close()


def test_a_database_that_is_broken_already_is_not_migrated(tmp_path: Path) -> None:
    database = Database(Settings(data_dir=tmp_path))
    database.migrate()
    database.revert("v0002")
    with database.engine.connect() as connection:
        connection.rollback()
        raw = connection.connection.driver_connection
        assert raw is not None
        raw.execute("PRAGMA foreign_keys=OFF")
        raw.execute("INSERT INTO job_events VALUES ('nobody', 1, 'log', '{}', '2026-01-01 00:00:00.000000')")
        raw.execute("PRAGMA foreign_keys=ON")
    with pytest.raises(InternalError) as caught:
        database.migrate()
    assert caught.value.code == "database.inconsistent"
    assert not database.is_migrated()
    database.close()
