"""The event log of a job: dense, ordered, complete, on both databases."""

from __future__ import annotations

import threading

import pytest

from store import announcement
from store.events import Events
from store.jobs import Jobs
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import REFUSED, claimed, finish


def test_the_whole_story_of_a_job(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    jobs.append_events(job.id, job.lease_token, [("log", {"message": "hello"})])
    jobs.renew(job.id, job.lease_token, 30.0, 10.0)
    jobs.fail(job.id, job.lease_token, REFUSED)
    jobs.retry(DEFAULT_WORKSPACE, job.id)
    story = events.after(DEFAULT_WORKSPACE, job.id)
    assert [event.seq for event in story] == list(range(1, 7))
    assert [event.type for event in story] == ["status", "status", "log", "progress", "done", "status"]
    assert [event.data["status"] for event in story if "status" in event.data] == ["accepted", "running", "failed", "accepted"]
    assert [event.at for event in story] == sorted(event.at for event in story)
    assert jobs.get(DEFAULT_WORKSPACE, job.id).event_seq == 6


def test_reading_goes_on_after_a_number(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    jobs.append_events(job.id, job.lease_token, [("log", {"number": number}) for number in range(10)])
    assert [event.seq for event in events.after(DEFAULT_WORKSPACE, job.id, 5)] == [6, 7, 8, 9, 10, 11, 12]
    assert [event.seq for event in events.after(DEFAULT_WORKSPACE, job.id, 5, limit=2)] == [6, 7]
    assert events.after(DEFAULT_WORKSPACE, job.id, 12) == []
    assert events.after(DEFAULT_WORKSPACE, "nobody's job") == []


def test_two_jobs_do_not_share_numbers(jobs: Jobs, events: Events) -> None:
    one, other = claimed(jobs), claimed(jobs)
    finish(jobs, one)
    finish(jobs, other)
    assert (
        [event.seq for event in events.after(DEFAULT_WORKSPACE, one.id)]
        == [event.seq for event in events.after(DEFAULT_WORKSPACE, other.id)]
        == [1, 2, 3]
    )


def test_a_reader_never_sees_a_gap(jobs: Jobs, events: Events) -> None:
    job = claimed(jobs)
    writers_left = threading.Barrier(3)

    def write(name: str) -> None:
        for number in range(20):
            jobs.append_events(job.id, job.lease_token, [("log", {"writer": name, "number": number})])
        writers_left.wait(timeout=60)

    threads = [threading.Thread(target=write, args=(name,)) for name in ("a", "b")]
    for thread in threads:
        thread.start()
    seen: list[int] = []
    while writers_left.n_waiting < 2 or events.after(DEFAULT_WORKSPACE, job.id, len(seen), limit=1):
        seen += [event.seq for event in events.after(DEFAULT_WORKSPACE, job.id, len(seen))]
    writers_left.wait(timeout=60)
    for thread in threads:
        thread.join()
    assert seen == list(range(1, 43))


def test_a_job_that_talks_without_end_is_cut_off_but_still_ends(
    jobs: Jobs, events: Events, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(announcement, "EVENT_LIMIT", 5)
    job = claimed(jobs)
    jobs.append_events(job.id, job.lease_token, [("log", {"number": number}) for number in range(10)])
    assert len(events.after(DEFAULT_WORKSPACE, job.id)) == 5
    assert finish(jobs, job)
    assert [event.type for event in events.after(DEFAULT_WORKSPACE, job.id, 5)] == ["done"]
