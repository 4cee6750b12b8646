"""What is older than its days goes; what anybody still needs stays. On both databases."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path

import pytest
from sqlalchemy import func, select, update

from core.errors import StateError
from store.callback import Subscriber
from store.callbacks import Callbacks
from store.database import Database
from store.events import Events
from store.job import Job, JobStatus, MeshInput
from store.jobs import Jobs
from store.local_blobs import LocalBlobs
from store.meshes import Meshes, MeshUpload
from store.records import EventRow, JobRow, MeshRow
from store.references import References
from store.retention import EVENTS_AT_A_TIME, JOBS_AT_A_TIME, Expired, Retention
from store.retention_policy import OwnRetention, RetentionPolicies, RetentionPolicy
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces
from tests.store.samples import claimed, finish

LAB = WorkspaceId("lab")
AS_SERVER = OwnRetention(None, None, None)


@pytest.fixture
def policies(db: Database) -> RetentionPolicies:
    """A server that keeps jobs for 30 days, uploads for 10 and talk for 2."""
    return RetentionPolicies(db, RetentionPolicy(30, 10, 2))


@pytest.fixture
def retention(db: Database, policies: RetentionPolicies) -> Retention:
    return Retention(db, policies)


def ended(db: Database, jobs: Jobs, days_ago: float, **inputs: MeshInput) -> Job:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {}, mesh_inputs=inputs.values())
    held = jobs.claim(job.id, 1, "me", 30)
    assert held is not None
    jobs.append_events(job.id, held.lease_token, [("log", {"message": "half"})])
    assert finish(jobs, held)
    age(db, job.id, days_ago)
    return jobs.get(DEFAULT_WORKSPACE, job.id)


def age(db: Database, job_id: str, days: float) -> None:
    with db.session() as session:
        moment = db.now(session) - timedelta(days=days)
        session.execute(update(JobRow).where(JobRow.id == job_id).values(finished_at=moment))


def uploaded(db: Database, blobs: LocalBlobs, tmp_path: Path, days_ago: float, content: bytes = b"mesh") -> str:
    path = tmp_path / "file"
    path.write_bytes(content)
    meshes = Meshes(db, blobs)
    mesh = meshes.create(DEFAULT_WORKSPACE, MeshUpload(path, path, "m", "m.stl", "mm", "stl", 4, 4, (1, 1, 1)))
    with db.session() as session:
        moment = db.now(session) - timedelta(days=days_ago)
        session.execute(update(MeshRow).where(MeshRow.id == mesh.id).values(created_at=moment))
    return mesh.id


def known(jobs: Jobs) -> set[str]:
    return {job.id for job in jobs.list(DEFAULT_WORKSPACE, limit=200).items}


def test_nothing_goes_by_itself(db: Database, jobs: Jobs) -> None:
    ended(db, jobs, 10_000)
    unset = Retention(db, RetentionPolicies(db, RetentionPolicy.of(Settings())))
    assert sum(unset.count().values(), Expired()).is_nothing
    assert unset.sweep().is_nothing


def test_jobs_go_after_their_days_with_rows_and_files(db: Database, jobs: Jobs, retention: Retention) -> None:
    old, young = ended(db, jobs, 31), ended(db, jobs, 29)
    assert retention.count()[DEFAULT_WORKSPACE].jobs == 1
    assert known(jobs) == {old.id, young.id}, "counting changes nothing"
    assert retention.sweep().jobs == 1
    assert known(jobs) == {young.id}
    assert Events(db).after(DEFAULT_WORKSPACE, old.id) == []
    with pytest.raises(StateError, match="no job"):
        jobs.get(DEFAULT_WORKSPACE, old.id)
    assert retention.sweep().is_nothing


def test_live_jobs_stay_whatever_their_age(db: Database, jobs: Jobs, retention: Retention) -> None:
    waiting, running = jobs.create(DEFAULT_WORKSPACE, "heal", {}), claimed(jobs)
    again = ended(db, jobs, 100)
    with db.session() as session:  # as it is between a retry and its first event
        session.execute(update(JobRow).where(JobRow.id == again.id).values(status=JobStatus.ACCEPTED))
        session.execute(update(JobRow).values(created_at=db.now(session) - timedelta(days=1000)))
    retention.sweep()
    assert known(jobs) == {waiting.id, running.id, again.id}


def test_what_a_live_job_reads_outlives_the_job_it_came_from(
    db: Database, jobs: Jobs, retention: Retention, blobs: LocalBlobs
) -> None:
    source = ended(db, jobs, 100)
    blob = blobs.put_bytes(b"fat")
    jobs.create(
        DEFAULT_WORKSPACE,
        "smooth",
        {},
        mesh_inputs=[MeshInput(f"/v1/jobs/{source.id}/results/fat", "fat", blob.sha256, "model/stl", "fat.stl")],
    )
    assert retention.sweep().jobs == 1
    assert blob.sha256 in References(db).all()
    assert blobs.sweep(References(db).all(), -1.0) == []


def test_uploads_go_unless_a_job_reads_them(
    db: Database, jobs: Jobs, retention: Retention, blobs: LocalBlobs, tmp_path: Path
) -> None:
    unused, used = uploaded(db, blobs, tmp_path, 11, b"unused"), uploaded(db, blobs, tmp_path, 11, b"used")
    young = uploaded(db, blobs, tmp_path, 9, b"young")
    record = Meshes(db, blobs).get(DEFAULT_WORKSPACE, used)
    given = MeshInput(f"/v1/meshes/{used}", "m", record.canonical_sha256, "model/stl", "m.stl")
    reader = ended(db, jobs, 20, mesh=given)
    assert retention.sweep().meshes == 1
    assert {mesh.id for mesh in Meshes(db, blobs).list(DEFAULT_WORKSPACE).items} == {used, young}
    age(db, reader.id, 40)
    assert retention.sweep() == Expired(jobs=1, meshes=1, events_of=0)
    assert {mesh.id for mesh in Meshes(db, blobs).list(DEFAULT_WORKSPACE).items} == {young}
    assert unused != used


def test_talk_goes_first_and_how_it_ended_stays(db: Database, jobs: Jobs, retention: Retention) -> None:
    job = ended(db, jobs, 3)
    assert "log" in [event.type for event in Events(db).after(DEFAULT_WORKSPACE, job.id)]
    assert retention.count()[DEFAULT_WORKSPACE].events_of == 1
    assert retention.sweep().events_of == 1
    assert [event.type for event in Events(db).after(DEFAULT_WORKSPACE, job.id)] == ["status", "status", "done"]
    assert retention.sweep().is_nothing, "once is enough"


def test_talk_of_a_retry_is_trimmed_again(db: Database, jobs: Jobs, retention: Retention) -> None:
    job = ended(db, jobs, 3)
    retention.sweep()
    with db.session() as session:
        trimmed = db.now(session) - timedelta(days=2.9)
        session.execute(update(JobRow).values(events_trimmed_at=trimmed, finished_at=trimmed + timedelta(hours=1)))
    assert retention.sweep().events_of == 1
    assert jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.SUCCESSFUL


def test_jobs_whose_subscriber_was_not_told_wait(db: Database, jobs: Jobs, retention: Retention) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "heal", {}, subscriber=Subscriber("http://here", "https://there/success"))
    held = jobs.claim(job.id, 1, "me", 30)
    assert held is not None
    finish(jobs, held)
    age(db, job.id, 100)
    assert retention.sweep().jobs == 0
    callback = Callbacks(db).claim(30, 10)
    assert callback is not None
    Callbacks(db).deliver(callback, 204)
    assert retention.sweep().jobs == 1


def test_a_workspace_has_days_of_its_own(db: Database, jobs: Jobs, retention: Retention, policies: RetentionPolicies) -> None:
    Workspaces(db).create("lab")
    job = ended(db, jobs, 40)
    policies.set(DEFAULT_WORKSPACE, OwnRetention(0, None, None))
    policies.set(LAB, OwnRetention(1, 1, 1))
    assert policies.all() == {DEFAULT_WORKSPACE: RetentionPolicy(0, 10, 2), LAB: RetentionPolicy(1, 1, 1)}
    assert retention.sweep().jobs == 0
    assert known(jobs) == {job.id}
    policies.set(DEFAULT_WORKSPACE, AS_SERVER)
    assert retention.sweep().jobs == 1
    with pytest.raises(StateError):
        policies.set(WorkspaceId("nowhere"), AS_SERVER)


def test_jobs_tell_when_they_expire(db: Database, policies: RetentionPolicies) -> None:
    jobs = Jobs(db, retention=policies)
    job = ended(db, jobs, 1)
    assert job.finished_at is not None
    assert job.expires_at == job.finished_at + timedelta(days=30)
    assert jobs.list(DEFAULT_WORKSPACE).items[0].expires_at == job.expires_at
    assert jobs.get(DEFAULT_WORKSPACE, claimed(jobs).id).expires_at is None
    policies.set(DEFAULT_WORKSPACE, OwnRetention(0, None, None))
    assert jobs.get(DEFAULT_WORKSPACE, job.id).expires_at is None


def test_transactions_stay_small(db: Database, jobs: Jobs, retention: Retention, monkeypatch: pytest.MonkeyPatch) -> None:
    """However much there is, no transaction takes more than a bounded number of jobs and events along."""
    for _ in range(JOBS_AT_A_TIME + 2):
        ended(db, jobs, 100)
    chatty = ended(db, jobs, 101)
    with db.session() as session:
        session.execute(update(JobRow).where(JobRow.id == chatty.id).values(event_seq=EVENTS_AT_A_TIME))
    sizes = []
    remove = Retention._remove_jobs

    def watched(self: Retention, *given: object) -> int:
        sizes.append(remove(self, *given))  # type: ignore[arg-type]
        return sizes[-1]

    monkeypatch.setattr(Retention, "_remove_jobs", watched)
    assert retention.sweep(60).jobs == JOBS_AT_A_TIME + 3
    assert sizes == [1, JOBS_AT_A_TIME, 2, 0]
    with db.reading() as session:
        assert session.execute(select(func.count()).select_from(EventRow)).scalar_one() == 0


def test_a_sweep_ends_when_its_time_is_over(db: Database, jobs: Jobs, retention: Retention) -> None:
    ended(db, jobs, 100)
    assert retention.sweep(0.0).is_nothing
    assert retention.sweep().jobs == 1
