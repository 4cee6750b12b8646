"""What a worker may do, and that a worker which lost its lease may do nothing, on both databases."""

from __future__ import annotations

from collections.abc import Callable
from datetime import timedelta

import pytest

from store.claims import Renewal
from store.events import Events
from store.job import Job, JobStatus
from store.jobs import Jobs
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import CRASHED, PACKAGE, REFUSED, REPORT, claimed, finish

Write = Callable[[Jobs, str, int], object]
WRITES: dict[str, Write] = {
    "renew": lambda jobs, job_id, token: jobs.renew(job_id, token, 30.0, 50.0, "phase", "message", [("log", {})]).kept,
    "append_events": lambda jobs, job_id, token: jobs.append_events(job_id, token, [("log", {"message": "late"})]),
    "finish": lambda jobs, job_id, token: jobs.finish(
        job_id, token, verdict="not_ready", summary="late", outputs={"package": PACKAGE}, timings_s={}
    ),
    "fail": lambda jobs, job_id, token: jobs.fail(job_id, token, CRASHED, outputs={"report": REPORT}),
    "fail with retry": lambda jobs, job_id, token: jobs.fail(job_id, token, CRASHED, retry=True),
    "release": lambda jobs, job_id, token: jobs.release(job_id, token),
    "confirm_dismissed": lambda jobs, job_id, token: jobs.confirm_dismissed(job_id, token),
}


def test_a_claim_takes_the_lease(jobs: Jobs) -> None:
    job = jobs.claim(jobs.create(DEFAULT_WORKSPACE, "shells", {}).id, 1, "worker-7", 30.0)
    assert job is not None
    assert (job.status, job.lease_owner, job.lease_token, job.phase) == (JobStatus.RUNNING, "worker-7", 1, "start")
    assert job.started_at is not None
    assert job.lease_until == job.started_at + timedelta(seconds=30)
    assert jobs.get(DEFAULT_WORKSPACE, job.id) == job


def test_a_second_message_finds_nothing_to_claim(jobs: Jobs) -> None:
    job = claimed(jobs)
    before = jobs.get(DEFAULT_WORKSPACE, job.id)
    assert jobs.claim(job.id, 1, "worker-2", 30.0) is None
    assert jobs.claim(job.id, 2, "worker-2", 30.0) is None
    assert jobs.claim("00000000-0000-4000-8000-000000000000", 1, "worker-2", 30.0) is None
    assert jobs.get(DEFAULT_WORKSPACE, job.id) == before


@pytest.mark.parametrize("write", WRITES.values(), ids=WRITES.keys())
@pytest.mark.parametrize("asked_to_dismiss", [False, True])
def test_a_stale_token_writes_nothing(jobs: Jobs, events: Events, write: Write, asked_to_dismiss: bool) -> None:
    old = claimed(jobs)
    jobs.release(old.id, old.lease_token)
    new = jobs.claim(old.id, 1, "worker-2", 30.0)
    assert new is not None
    if asked_to_dismiss:
        jobs.dismiss(DEFAULT_WORKSPACE, new.id)
    before, told = jobs.get(DEFAULT_WORKSPACE, new.id), events.after(DEFAULT_WORKSPACE, new.id)
    for token in (old.lease_token, new.lease_token + 1, 0):
        assert not write(jobs, new.id, token)
    assert jobs.get(DEFAULT_WORKSPACE, new.id) == before
    assert events.after(DEFAULT_WORKSPACE, new.id) == told


@pytest.mark.parametrize("write", WRITES.values(), ids=WRITES.keys())
@pytest.mark.parametrize("end", ["finish", "fail", "release", "fail with retry"])
def test_nothing_is_written_after_the_end(jobs: Jobs, events: Events, write: Write, end: str) -> None:
    job = claimed(jobs)
    assert WRITES[end](jobs, job.id, job.lease_token)
    before, told = jobs.get(DEFAULT_WORKSPACE, job.id), events.after(DEFAULT_WORKSPACE, job.id)
    repeated = end == "finish" and write is WRITES["finish"]  # its answer may have been lost, so it is given again
    assert bool(write(jobs, job.id, job.lease_token)) == repeated
    assert jobs.get(DEFAULT_WORKSPACE, job.id) == before
    assert events.after(DEFAULT_WORKSPACE, job.id) == told


def test_a_renewal_moves_the_lease_and_the_bar(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    assert jobs.renew(job.id, job.lease_token, 60.0, 40, "shells: fat", "12 of 30") == Renewal(True, False)
    seen = jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (seen.progress, seen.phase, seen.message) == (40.0, "shells: fat", "12 of 30")
    assert job.lease_until is not None
    assert seen.lease_until is not None
    assert seen.lease_until > job.lease_until + timedelta(seconds=29)
    last = events.after(DEFAULT_WORKSPACE, job.id)[-1]
    assert (last.type, last.data) == ("progress", {"progress": 40.0, "phase": "shells: fat", "message": "12 of 30"})


def test_a_renewal_without_news_adds_no_event(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    jobs.renew(job.id, job.lease_token, 60.0, 40, "a", "b")
    count = len(events.after(DEFAULT_WORKSPACE, job.id))
    jobs.renew(job.id, job.lease_token, 60.0, 40, "a", "b")
    jobs.renew(job.id, job.lease_token, 60.0)
    assert len(events.after(DEFAULT_WORKSPACE, job.id)) == count


@pytest.mark.parametrize(("told", "shown"), [(-5.0, 30.0), (10.0, 30.0), (30.5, 30.5), (250.0, 100.0)])
def test_progress_stays_within_its_bar_and_never_goes_back(jobs: Jobs, told: float, shown: float) -> None:
    job = claimed(jobs)
    jobs.renew(job.id, job.lease_token, 60.0, 30.0)
    jobs.renew(job.id, job.lease_token, 60.0, told)
    assert jobs.get(DEFAULT_WORKSPACE, job.id).progress == shown


def test_log_lines_come_before_the_progress_they_led_to(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    seq = job.event_seq
    jobs.renew(job.id, job.lease_token, 60.0, 50.0, events=[("log", {"message": "one"}), ("log", {"message": "two"})])
    assert [(event.seq, event.type) for event in events.after(DEFAULT_WORKSPACE, job.id, seq)] == [
        (seq + 1, "log"),
        (seq + 2, "log"),
        (seq + 3, "progress"),
    ]


def test_success_is_recorded_whole(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    assert finish(jobs, job) is True
    done = jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (done.status, done.verdict, done.summary, done.progress) == (
        JobStatus.SUCCESSFUL,
        "simulation_ready",
        "3 shells",
        100.0,
    )
    assert list(done.outputs.items()) == [("package", PACKAGE), ("report", REPORT)]
    assert (done.timings_s, done.peak_memory_bytes) == ({"shells: fat": 1.5}, 1_000_000)
    assert (done.lease_owner, done.lease_until) == (None, None)
    assert done.finished_at is not None
    last = events.after(DEFAULT_WORKSPACE, job.id)[-1]
    assert (last.type, last.seq) == ("done", done.event_seq)
    assert (last.data["status"], last.data["verdict"]) == ("successful", "simulation_ready")


def test_a_failure_says_whose_fault_and_keeps_its_report(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    failed = jobs.fail(job.id, job.lease_token, REFUSED, outputs={"report": REPORT}, timings_s={"intake": 0.1})
    assert failed is not None
    assert failed == jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (failed.status, failed.failure, failed.outputs) == (JobStatus.FAILED, REFUSED, {"report": REPORT})
    told = events.after(DEFAULT_WORKSPACE, job.id)[-1].data["failure"]
    assert (told["code"], told["class"], told["retryable"], told["facts"]) == ("skin.not_closed", "input", False, {"edges": 3})


def test_a_crash_is_tried_again_until_attempts_run_out(jobs: Jobs) -> None:
    job: Job | None = claimed(jobs)
    assert job is not None
    again = jobs.fail(job.id, job.lease_token, CRASHED, outputs={"report": REPORT}, retry=True)
    assert again is not None
    assert (again.status, again.attempt, again.failure, again.outputs) == (JobStatus.ACCEPTED, 2, None, {})
    job = jobs.claim(job.id, 2, "worker-2", 30.0)
    assert job is not None
    last = jobs.fail(job.id, job.lease_token, CRASHED, retry=True)
    assert last is not None
    assert (last.status, last.attempt, last.failure) == (JobStatus.FAILED, 2, CRASHED)


def test_a_failure_after_a_dismissal_is_a_dismissal(jobs: Jobs) -> None:
    job = claimed(jobs)
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    ended = jobs.fail(job.id, job.lease_token, CRASHED, retry=True)
    assert ended is not None
    assert (ended.status, ended.failure) == (JobStatus.DISMISSED, None)


def test_a_released_job_lost_no_attempt_and_is_due_at_once(jobs: Jobs) -> None:
    job = claimed(jobs)
    jobs.renew(job.id, job.lease_token, 30.0, 70.0, "late phase", "x")
    assert jobs.release(job.id, job.lease_token) is True
    waiting = jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (waiting.status, waiting.attempt, waiting.progress, waiting.phase) == (JobStatus.ACCEPTED, 1, 0.0, "")
    assert (job.id, 1) in jobs.due_to_ring(3600.0)
    again = jobs.claim(job.id, 1, "worker-2", 30.0)
    assert again is not None
    assert again.lease_token == job.lease_token + 1


def test_releasing_a_job_under_dismissal_ends_it(jobs: Jobs) -> None:
    job = claimed(jobs)
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    assert jobs.release(job.id, job.lease_token) is True
    assert jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.DISMISSED


def test_no_dismissal_is_confirmed_that_nobody_asked_for(jobs: Jobs) -> None:
    job = claimed(jobs)
    assert jobs.confirm_dismissed(job.id, job.lease_token) is False
    assert jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.RUNNING


def test_no_message_of_a_child_can_spoil_a_write(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    hostile = "NUL \x00, half a pair \ud800, " + "long " * 5000
    deep: list[object] = []
    for _ in range(200):
        deep = [deep]
    facts = {"nan": float("nan"), "inf": [float("-inf")], "deep": deep, "text": hostile, "odd": {1, 2}}
    assert jobs.renew(job.id, job.lease_token, 30.0, 1.0, hostile, hostile, [("log", {"message": hostile, **facts})]).kept
    log = events.after(DEFAULT_WORKSPACE, job.id)[-2].data
    assert log["message"].startswith("NUL \ufffd, half a pair ?")
    assert len(log["message"]) <= 8000
    assert (log["nan"], log["inf"]) == ("nan", ["-inf"])
    assert jobs.finish(job.id, job.lease_token, verdict="not_ready", summary=hostile, outputs={}, timings_s={"x": float("inf")})
