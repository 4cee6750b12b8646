"""Accepting, finding, listing, dismissing and retrying jobs, on both databases."""

from __future__ import annotations

from datetime import UTC, datetime
from uuid import UUID

import pytest

from core.errors import InputError, StateError
from store.database import Database
from store.events import Events
from store.job import Job, JobStatus, MeshInput
from store.job_search import JobSearch
from store.jobs import Jobs
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import REFUSED, claimed, finish

SKIN = MeshInput("/v1/meshes/1", "skin", "c" * 64, "model/stl", "skin.stl", "d" * 64)


def test_a_created_job_comes_back_as_it_was_sent(jobs: Jobs) -> None:
    inputs = {"zebra": 0.1, "apple": [1, 2.5, {"b": None, "a": "é\x00\ud800"}], "min_gap_mm": 1e-17}
    before = datetime.now(UTC)
    job = jobs.create(DEFAULT_WORKSPACE, "shells", inputs, mesh_inputs=[SKIN, SKIN], max_attempts=3)
    found = jobs.get(DEFAULT_WORKSPACE, job.id)
    assert found == job
    assert UUID(job.id).version == 4
    assert (job.status, job.attempt, job.max_attempts, job.lease_token) == (JobStatus.ACCEPTED, 1, 3, 0)
    assert list(found.inputs) == list(inputs)  # the order too: it may name outputs
    assert found.inputs == inputs
    assert found.mesh_inputs == {SKIN.href: SKIN}
    assert found.created_at.tzinfo is UTC
    assert abs((found.created_at - before).total_seconds()) < 60


def test_a_job_nobody_made_is_not_found(jobs: Jobs) -> None:
    for ask in (jobs.get, jobs.dismiss, jobs.retry, jobs.queue_position):
        with pytest.raises(StateError) as caught:
            ask(DEFAULT_WORKSPACE, "00000000-0000-4000-8000-000000000000")
        assert caught.value.code == "job.not_found"


def test_creation_joins_a_transaction_and_vanishes_with_it(jobs: Jobs, db: Database) -> None:
    def create_and_break() -> None:
        with db.session() as session:
            jobs.create(DEFAULT_WORKSPACE, "shells", {}, session=session)
            raise RuntimeError("on purpose")

    with pytest.raises(RuntimeError, match="on purpose"):
        create_and_break()
    assert jobs.list(DEFAULT_WORKSPACE).items == ()


def test_pages_cover_every_job_once_newest_first(jobs: Jobs) -> None:
    made = [jobs.create(DEFAULT_WORKSPACE, "shells", {"number": number}) for number in range(7)]
    seen: list[Job] = []
    cursor = None
    for size in (3, 3, 1):
        page = jobs.list(DEFAULT_WORKSPACE, limit=3, cursor=cursor)
        assert len(page.items) == size
        seen += page.items
        cursor = page.next
        jobs.create(DEFAULT_WORKSPACE, "validate", {})  # a new job in between shifts nothing
    assert cursor is None
    assert seen == sorted(made, key=lambda job: (job.created_at, job.id), reverse=True)


def test_an_exact_page_is_the_last(jobs: Jobs) -> None:
    for _ in range(3):
        jobs.create(DEFAULT_WORKSPACE, "shells", {})
    assert jobs.list(DEFAULT_WORKSPACE, limit=3).next is None


def test_filters_mean_any_of_their_values(jobs: Jobs) -> None:
    running = claimed(jobs, "shells")
    waiting = jobs.create(DEFAULT_WORKSPACE, "validate", {})
    done = claimed(jobs, "validate")
    finish(jobs, done)

    def ids(page: tuple[Job, ...]) -> set[str]:
        return {job.id for job in page}

    assert ids(jobs.list(DEFAULT_WORKSPACE, JobSearch(("running",))).items) == {running.id}
    assert ids(jobs.list(DEFAULT_WORKSPACE, JobSearch(("running", "successful"))).items) == {running.id, done.id}
    assert ids(jobs.list(DEFAULT_WORKSPACE, JobSearch(process=("validate",))).items) == {waiting.id, done.id}
    assert ids(jobs.list(DEFAULT_WORKSPACE, JobSearch(("accepted",), ("validate",))).items) == {waiting.id}
    assert jobs.list(DEFAULT_WORKSPACE, JobSearch(process=("ears",))).items == ()


@pytest.mark.parametrize("cursor", ["", "x", "é", "AAAA", "bm90IGEgZGF0ZSBhYmM", "MjAyNi0wMS0wMVQwMDowMDowMCBh"])
def test_a_foreign_cursor_is_refused(jobs: Jobs, cursor: str) -> None:
    with pytest.raises(InputError) as caught:
        jobs.list(DEFAULT_WORKSPACE, cursor=cursor)
    assert caught.value.code == "cursor.invalid"


def test_queue_positions_count_from_one_and_close_up(jobs: Jobs) -> None:
    first, second, third = (jobs.create(DEFAULT_WORKSPACE, "shells", {}) for _ in range(3))
    assert [jobs.queue_position(DEFAULT_WORKSPACE, job.id) for job in (first, second, third)] == [1, 2, 3]
    jobs.claim(first.id, 1, "worker", 30.0)
    assert [jobs.queue_position(DEFAULT_WORKSPACE, job.id) for job in (first, second, third)] == [None, 1, 2]
    jobs.dismiss(DEFAULT_WORKSPACE, second.id)
    assert jobs.queue_position(DEFAULT_WORKSPACE, third.id) == 1


def test_a_waiting_job_is_dismissed_at_once(jobs: Jobs, events: Events) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {})
    dismissed = jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    assert dismissed.status is JobStatus.DISMISSED
    assert dismissed.finished_at is not None
    assert events.after(DEFAULT_WORKSPACE, job.id)[-1].type == "done"
    assert jobs.claim(job.id, 1, "worker", 30.0) is None


def test_a_running_job_is_dismissed_by_its_worker(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    assert jobs.renew(job.id, job.lease_token, 30.0).dismiss_requested is False
    asked = jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    assert (asked.status, asked.dismiss_requested) == (JobStatus.RUNNING, True)
    count = len(events.after(DEFAULT_WORKSPACE, job.id))
    assert jobs.dismiss(DEFAULT_WORKSPACE, job.id) == asked  # asking again changes nothing
    assert len(events.after(DEFAULT_WORKSPACE, job.id)) == count
    assert jobs.renew(job.id, job.lease_token, 30.0).dismiss_requested is True
    assert jobs.confirm_dismissed(job.id, job.lease_token) is True
    assert jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.DISMISSED


def test_a_dismissed_job_never_turns_out_successful(jobs: Jobs) -> None:
    job = claimed(jobs)
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    assert finish(jobs, job) is False
    ended = jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (ended.status, ended.outputs, ended.verdict) == (JobStatus.DISMISSED, {}, None)


def test_dismissing_a_finished_job_removes_it(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    finish(jobs, job)
    told = jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    assert (told.id, told.status) == (job.id, JobStatus.DISMISSED)
    assert events.after(DEFAULT_WORKSPACE, job.id) == []
    with pytest.raises(StateError):
        jobs.get(DEFAULT_WORKSPACE, job.id)


def test_a_failed_job_is_retried_once_more(jobs: Jobs) -> None:
    job = claimed(jobs)
    jobs.fail(job.id, job.lease_token, REFUSED)
    again = jobs.retry(DEFAULT_WORKSPACE, job.id)
    assert (again.status, again.attempt, again.failure, again.finished_at) == (JobStatus.ACCEPTED, 2, None, None)
    assert jobs.claim(job.id, 1, "worker", 30.0) is None  # an old message
    second = jobs.claim(job.id, 2, "worker", 30.0)
    assert second is not None
    jobs.fail(job.id, second.lease_token, REFUSED)
    third = jobs.retry(DEFAULT_WORKSPACE, job.id)
    assert (third.attempt, third.max_attempts) == (3, 3)


def test_a_dismissed_job_can_be_retried(jobs: Jobs) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {})
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    assert jobs.retry(DEFAULT_WORKSPACE, job.id).status is JobStatus.ACCEPTED


def test_only_failed_and_dismissed_jobs_are_retried(jobs: Jobs) -> None:
    waiting, running, done = jobs.create(DEFAULT_WORKSPACE, "shells", {}), claimed(jobs), claimed(jobs)
    finish(jobs, done)
    for job in (waiting, running, done):
        with pytest.raises(StateError) as caught:
            jobs.retry(DEFAULT_WORKSPACE, job.id)
        assert caught.value.code == "job.not_retryable"
        assert caught.value.facts["status"] == jobs.get(DEFAULT_WORKSPACE, job.id).status
