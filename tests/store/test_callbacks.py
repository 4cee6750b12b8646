"""The outbox on both databases: written with the change it tells of, held by one deliverer at a time."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta

import pytest
from sqlalchemy import update

from core.errors import StateError
from store.callback import Callback, CallbackEvent, CallbackState, Subscriber
from store.callbacks import Callbacks
from store.database import Database
from store.job import Job, JobFailure
from store.jobs import Jobs
from store.records import CallbackRow
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces
from tests.store.samples import CRASHED, REFUSED, finish

EVERYWHERE = Subscriber("http://127.0.0.1:8000/", "https://a.example/s", "https://a.example/p", "https://a.example/f")
MAX_ATTEMPTS = 3
IN_PROGRESS, SUCCESS, FAILED = CallbackEvent.IN_PROGRESS, CallbackEvent.SUCCESS, CallbackEvent.FAILED


@pytest.fixture
def callbacks(db: Database) -> Callbacks:
    """The table."""
    return Callbacks(db)


def running(jobs: Jobs, subscriber: Subscriber | None = EVERYWHERE, workspace: WorkspaceId = DEFAULT_WORKSPACE) -> Job:
    waiting = jobs.create(workspace, "validate", {}, subscriber=subscriber)
    job = jobs.claim(waiting.id, 1, "worker-1", 30.0)
    assert job is not None
    return job


def told(callbacks: Callbacks, job: Job) -> list[CallbackEvent]:
    return [one.event for one in callbacks.of_job(job.workspace, job.id)]


def let_lease_run_out(db: Database) -> None:
    with db.session() as session:
        past = db.now(session) - timedelta(seconds=1)
        session.execute(update(CallbackRow).where(CallbackRow.lease_until.is_not(None)).values(lease_until=past))


def take(callbacks: Callbacks) -> Callback:
    taken = callbacks.claim(30.0, MAX_ATTEMPTS)
    assert taken is not None
    return taken


def test_each_change_is_told_once(jobs: Jobs, callbacks: Callbacks) -> None:
    waiting = jobs.create(DEFAULT_WORKSPACE, "validate", {}, subscriber=EVERYWHERE)
    assert told(callbacks, waiting) == []
    job = jobs.claim(waiting.id, 1, "worker-1", 30.0)
    assert job is not None
    assert told(callbacks, job) == [IN_PROGRESS]
    jobs.renew(job.id, job.lease_token, 30.0, 50.0, "phase", "message")
    assert told(callbacks, job) == [IN_PROGRESS]
    finish(jobs, job)
    started, ended = callbacks.of_job(DEFAULT_WORKSPACE, job.id)
    assert (started.event, started.uri, ended.event, ended.uri) == (
        IN_PROGRESS,
        "https://a.example/p",
        SUCCESS,
        "https://a.example/s",
    )
    body = json.loads(ended.body)
    assert (body["jobID"], body["status"], body["verdict"]) == (job.id, "successful", "simulation_ready")
    assert [link["href"] for link in body["links"]] == [
        f"http://127.0.0.1:8000/v1/jobs/{job.id}",
        f"http://127.0.0.1:8000/v1/jobs/{job.id}/results",
    ]
    assert finish(jobs, job), "the same word again"
    assert not jobs.renew(job.id, job.lease_token, 30.0).kept
    assert told(callbacks, job) == [IN_PROGRESS, SUCCESS]


def test_a_failure_is_told_when_it_is_final(jobs: Jobs, callbacks: Callbacks) -> None:
    job = running(jobs)
    jobs.fail(job.id, job.lease_token, CRASHED, retry=True)
    assert told(callbacks, job) == [IN_PROGRESS]
    again = jobs.claim(job.id, 2, "worker-2", 30.0)
    assert again is not None
    jobs.fail(again.id, again.lease_token, REFUSED)
    assert told(callbacks, job) == [IN_PROGRESS, IN_PROGRESS, FAILED]
    failure = json.loads(callbacks.of_job(DEFAULT_WORKSPACE, job.id)[-1].body)["failure"]
    assert (failure["code"], failure["class"], "facts" in failure) == ("skin.not_closed", "input", False)


def test_a_lost_worker_is_told_too(jobs: Jobs, callbacks: Callbacks) -> None:
    waiting = jobs.create(DEFAULT_WORKSPACE, "validate", {}, subscriber=EVERYWHERE, max_attempts=1)
    job = jobs.claim(waiting.id, 1, "worker-1", 30.0)
    assert job is not None
    jobs.expire_all_leases()
    assert told(callbacks, job) == [IN_PROGRESS, FAILED]


@pytest.mark.parametrize("subscriber", [None, Subscriber("http://h/", "https://a.example/s")])
def test_who_did_not_ask_is_not_told(jobs: Jobs, callbacks: Callbacks, subscriber: Subscriber | None) -> None:
    job = running(jobs, subscriber)
    jobs.fail(job.id, job.lease_token, REFUSED)
    assert told(callbacks, job) == []


def test_a_dismissal_is_told_as_the_end_it_is_and_a_removed_job_takes_its_callbacks_along(
    jobs: Jobs, callbacks: Callbacks
) -> None:
    job = running(jobs)
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    jobs.confirm_dismissed(job.id, job.lease_token)
    _, ended = callbacks.of_job(DEFAULT_WORKSPACE, job.id)
    assert (ended.event, ended.uri) == (CallbackEvent.DISMISSED, "https://a.example/f")
    assert json.loads(ended.body)["status"] == "dismissed"
    waiting = jobs.create(DEFAULT_WORKSPACE, "validate", {}, subscriber=EVERYWHERE)
    jobs.dismiss(DEFAULT_WORKSPACE, waiting.id)
    assert told(callbacks, waiting) == [CallbackEvent.DISMISSED]
    for one in (job, waiting):
        jobs.dismiss(DEFAULT_WORKSPACE, one.id)
    assert callbacks.claim(30.0, MAX_ATTEMPTS) is None
    with pytest.raises(StateError, match="no job"):
        callbacks.of_job(DEFAULT_WORKSPACE, job.id)


def test_a_change_that_is_rolled_back_tells_nothing(jobs: Jobs, callbacks: Callbacks, monkeypatch: pytest.MonkeyPatch) -> None:
    job = running(jobs, Subscriber("http://h/", "https://a.example/s", None, "https://a.example/f"))

    def break_off(*_: object) -> None:
        raise RuntimeError("on purpose")

    monkeypatch.setattr("store.claims.snapshot", break_off)  # after everything was written, before the commit
    with pytest.raises(RuntimeError, match="on purpose"):
        jobs.fail(job.id, job.lease_token, REFUSED)
    monkeypatch.undo()
    assert jobs.get(DEFAULT_WORKSPACE, job.id).status == "running"
    assert told(callbacks, job) == []


def test_the_longest_words_fit_into_20_kb(jobs: Jobs, callbacks: Callbacks) -> None:
    job = running(jobs)
    failure = JobFailure("limit.memory", "limit", "𝄞" * 7_000, True, {"long": "x" * 50_000})
    jobs.fail(job.id, job.lease_token, failure)
    assert len(callbacks.of_job(DEFAULT_WORKSPACE, job.id)[-1].body.encode()) < 20_000


def test_one_deliverer_has_it(settings: Settings, jobs: Jobs, callbacks: Callbacks) -> None:
    for _ in range(5):
        running(jobs)
    deliverers = [Callbacks(Database(settings)) for _ in range(4)]
    with ThreadPoolExecutor(4) as pool:
        taken = list(pool.map(lambda table: [table.claim(30.0, MAX_ATTEMPTS) for _ in range(4)], deliverers))
    ids = [one.id for some in taken for one in some if one is not None]
    assert len(ids) == len(set(ids)) == 5
    assert not callbacks.any_due()
    for table in deliverers:
        table._db.close()


def test_a_lost_lease_is_taken_over_and_its_holder_changes_nothing(db: Database, jobs: Jobs, callbacks: Callbacks) -> None:
    running(jobs)
    first = take(callbacks)
    assert callbacks.claim(30.0, MAX_ATTEMPTS) is None
    let_lease_run_out(db)
    second = take(callbacks)
    assert (second.id, second.body, second.attempts) == (first.id, first.body, 2)
    assert not callbacks.deliver(first, 200)
    assert not callbacks.bury(first, None, "late")
    assert not callbacks.put_off(first, None, "late", 5.0)
    assert callbacks.deliver(second, 204)
    assert not callbacks.deliver(second, 204)
    (done,) = callbacks.of_job(DEFAULT_WORKSPACE, first.job_id)
    assert (done.state, done.last_status, done.attempts) == (CallbackState.DELIVERED, 204, 2)
    assert done.ended_at is not None


def test_a_deliverer_that_dies_every_time_is_not_fed_for_ever(db: Database, jobs: Jobs, callbacks: Callbacks) -> None:
    job = running(jobs)
    for _ in range(MAX_ATTEMPTS):
        take(callbacks)
        let_lease_run_out(db)
    assert callbacks.claim(30.0, MAX_ATTEMPTS) is None
    (dead,) = callbacks.of_job(DEFAULT_WORKSPACE, job.id)
    assert (dead.state, dead.attempts) == (CallbackState.DEAD, MAX_ATTEMPTS)
    assert callbacks.count() == {CallbackState.PENDING: 0, CallbackState.DEAD: 1}
    assert callbacks.replay(DEFAULT_WORKSPACE, job.id) == 1
    assert callbacks.replay(DEFAULT_WORKSPACE, job.id) == 0
    again = take(callbacks)
    assert (again.id, again.body, again.attempts) == (dead.id, dead.body, 1)


def test_what_was_put_off_waits(jobs: Jobs, callbacks: Callbacks) -> None:
    job = running(jobs)
    taken = take(callbacks)
    assert callbacks.put_off(taken, 500, "answered 500", 3600.0)
    assert not callbacks.any_due()
    assert callbacks.claim(30.0, MAX_ATTEMPTS) is None
    (waiting,) = callbacks.of_job(DEFAULT_WORKSPACE, job.id)
    assert (waiting.state, waiting.last_status, waiting.last_error) == (CallbackState.PENDING, 500, "answered 500")
    assert waiting.due_at - waiting.created_at > timedelta(minutes=59)
    finish(jobs, job)  # its start was tried in vain: only the end is told now
    assert told(callbacks, job) == [SUCCESS]


def test_dead_receivers_hold_up_their_own_workspace_only(db: Database, jobs: Jobs, callbacks: Callbacks) -> None:
    other = Workspaces(db).create("other").id
    for _ in range(3):
        running(jobs)
    late = running(jobs, workspace=other)
    assert take(callbacks).workspace == DEFAULT_WORKSPACE
    assert take(callbacks).job_id == late.id


def test_another_workspace_sees_and_replays_nothing(db: Database, jobs: Jobs, callbacks: Callbacks) -> None:
    other = Workspaces(db).create("other").id
    job = running(jobs)
    for act in (callbacks.of_job, callbacks.replay):
        with pytest.raises(StateError, match="no job"):
            act(other, job.id)
