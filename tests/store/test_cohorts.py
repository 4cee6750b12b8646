"""Cohorts: every job has a row, the end of the last one queues one summary, whatever happens at once; on both databases."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta

import pytest
from sqlalchemy import func, select

from core.errors import LimitError, StateError
from core.schema.cohort import COHORT_SUMMARY
from core.schema.expectation import UNKNOWN
from store.cohort import Cohort, RefusedSubject
from store.cohorts import Cohorts, NewCohort, NewSubject
from store.database import Database
from store.job import Job, JobStatus, MeshInput
from store.job_search import JobSearch
from store.job_words import JobWords
from store.jobs import Jobs
from store.quotas import Quotas
from store.records import CohortRow, JobRow
from store.retention import Retention
from store.retention_policy import RetentionPolicies, RetentionPolicy
from store.workspace import DEFAULT_WORKSPACE as HERE
from store.workspace import WorkspaceId
from store.workspaces import Workspaces
from tests.store.samples import CRASHED, REFUSED, REPORT, finish

MESH = MeshInput("/v1/meshes/1", "skin", "a" * 64, "model/stl", "skin.stl")


@pytest.fixture
def cohorts(db: Database, jobs: Jobs) -> Cohorts:
    return Cohorts(db, jobs)


def new(names: Iterable[str], refused: Iterable[str] = ()) -> NewCohort:
    subjects = [NewSubject(name, {"skin": {"href": MESH.href}}, (MESH,), UNKNOWN) for name in names]
    unread = [RefusedSubject(name, "format.unknown", "no mesh") for name in refused]
    return NewCohort("shells", {"min_gap_mm": 0.1}, subjects, unread, JobWords("Pilot", ("ages",)))


def begin(jobs: Jobs, job: Job) -> Job:
    taken = jobs.claim(job.id, job.attempt, "worker-1", 30.0)
    assert taken is not None
    return taken


def fail(jobs: Jobs, job: Job) -> None:
    taken = begin(jobs, job)
    assert jobs.fail(taken.id, taken.lease_token, REFUSED, outputs={"report": REPORT}) is not None


def summaries(db: Database) -> list[str]:
    with db.reading() as session:
        return list(session.scalars(select(JobRow.id).where(JobRow.process == COHORT_SUMMARY)))


def test_the_last_end_queues_the_summary_of_all(cohorts: Cohorts, jobs: Jobs, db: Database) -> None:
    cohort, members = cohorts.create(HERE, new(["a", "b", "c"], ["broken"]))
    assert (cohort.subjects, cohort.live, cohort.progress, cohort.finished_at) == (4, 3, 0.0, None)
    assert [(job.cohort_id, job.subject, job.name, job.labels) for job in members] == [
        (cohort.id, name, "Pilot", ("ages",)) for name in "abc"
    ]
    assert finish(jobs, begin(jobs, members[0]))
    fail(jobs, members[1])
    assert (summaries(db), cohorts.get(HERE, cohort.id).finished_at) == ([], None)
    assert cohorts.get(HERE, cohort.id).progress == pytest.approx(200 / 3)
    jobs.dismiss(HERE, members[2].id)
    ended = cohorts.get(HERE, cohort.id)
    assert [ended.summary_job_id] == summaries(db)
    assert (ended.ready, ended.round, ended.progress, ended.live) == (1, 1, 100.0, 0)
    assert ended.counts == {JobStatus.SUCCESSFUL: 1, JobStatus.FAILED: 1, JobStatus.DISMISSED: 1}
    summary = jobs.get(HERE, str(ended.summary_job_id))
    told = summary.inputs["subjects"]
    assert [(one["subject"], one["status"], one.get("code")) for one in told] == [
        ("a", "successful", None),
        ("b", "failed", "skin.not_closed"),
        ("c", "dismissed", None),
        ("broken", "refused", "format.unknown"),
    ]
    assert list(summary.mesh_inputs) == sorted(told[number]["report"] for number in (0, 1))
    assert (summary.cohort_id, summary.queue, summary.status) == (None, "fast", "accepted")
    assert [job.id for job in cohorts.jobs(HERE, cohort.id)] == [job.id for job in members]
    assert {job.id for job in jobs.list(HERE, JobSearch(cohort_id=cohort.id)).items} == {job.id for job in members}


def test_of_ends_at_the_same_time_one_queues_the_summary(cohorts: Cohorts, jobs: Jobs, db: Database) -> None:
    _, members = cohorts.create(HERE, new(f"s{number}" for number in range(8)))
    running = [begin(jobs, job) for job in members]
    with ThreadPoolExecutor(8) as pool:
        assert all(pool.map(lambda job: finish(jobs, job), running))
    assert len(summaries(db)) == 1


def test_a_retry_opens_it_again_and_the_old_summary_goes(cohorts: Cohorts, jobs: Jobs, db: Database) -> None:
    cohort, members = cohorts.create(HERE, new(["a", "b", "c"]))
    finish(jobs, begin(jobs, members[0]))
    for job in members[1:]:
        fail(jobs, job)
    [first] = summaries(db)
    again, queued = cohorts.retry(HERE, cohort.id)
    assert {job.id for job in queued} == {job.id for job in members[1:]}
    assert (again.round, again.finished_at, again.live) == (2, None, 2)
    for job in queued:
        finish(jobs, begin(jobs, job))
    [second] = summaries(db)
    assert second != first
    assert cohorts.get(HERE, cohort.id).summary_job_id == second
    with pytest.raises(StateError) as refused:
        cohorts.retry(HERE, cohort.id)
    assert refused.value.code == "cohort.nothing_to_retry"


def test_a_summary_under_way_is_taken_back_when_a_single_job_is_retried(cohorts: Cohorts, jobs: Jobs, db: Database) -> None:
    _, [job] = cohorts.create(HERE, new(["a"]))
    fail(jobs, job)
    [first] = summaries(db)
    running = begin(jobs, jobs.get(HERE, first))
    again = jobs.retry(HERE, job.id)
    fail(jobs, again)
    assert len(summaries(db)) == 2
    assert jobs.renew(running.id, running.lease_token, 30.0).dismiss_requested
    assert not finish(jobs, running)


def test_lost_workers_end_a_cohort_too(cohorts: Cohorts, jobs: Jobs, db: Database) -> None:
    _, members = cohorts.create(HERE, new(["a", "b"]), max_attempts=1)
    for job in members:
        begin(jobs, job)
    assert len(jobs.expire_all_leases()) == 2
    assert len(summaries(db)) == 1


def test_an_end_that_was_told_by_an_older_server_is_found(cohorts: Cohorts, jobs: Jobs, db: Database) -> None:
    cohort, [job] = cohorts.create(HERE, new(["a"]))
    assert list(cohorts.close_ended()) == []
    with db.session() as session:
        session.get_one(JobRow, job.id).status = JobStatus.FAILED
    [summary] = cohorts.close_ended()
    assert summary.id == cohorts.get(HERE, cohort.id).summary_job_id
    assert list(cohorts.close_ended()) == []


def test_what_was_refused_whole_has_its_summary_at_once(cohorts: Cohorts, db: Database) -> None:
    cohort, jobs_made = cohorts.create(HERE, new([], ["x", "y"]))
    assert (jobs_made, cohort.progress, [cohort.summary_job_id]) == ((), 100.0, summaries(db))


def test_quotas_count_every_job_and_refuse_all_or_none(db: Database) -> None:
    cohorts = Cohorts(db, Jobs(db, Quotas(db, default_bytes=0, default_jobs=3)))
    with pytest.raises(LimitError) as refused:
        cohorts.create(HERE, new("abcd"))
    assert refused.value.code == "quota.jobs"
    assert cohorts.list(HERE).items == ()
    assert Jobs(db).list(HERE).items == ()
    cohorts.create(HERE, new("abc"))


def test_a_parked_request_names_its_subject_and_stays_out_of_a_retry(db: Database) -> None:
    jobs = Jobs(db, Quotas(db, default_bytes=0, default_jobs=0))
    cohorts = Cohorts(db, jobs)
    other = MeshInput("/v1/meshes/2", "other", "b" * 64, "model/stl", "other.stl")
    asked = new(["a"])
    second = NewSubject("b", {"skin": {"href": other.href}}, (other,), UNKNOWN)
    cohort, members = cohorts.create(HERE, NewCohort(asked.process, asked.inputs, [*asked.subjects, second]), max_attempts=1)
    taken = begin(jobs, members[0])
    jobs.fail(taken.id, taken.lease_token, CRASHED)
    fail(jobs, members[1])
    again, queued = cohorts.retry(HERE, cohort.id)
    assert ([job.subject for job in queued], again.counts[JobStatus.FAILED]) == (["b"], 1)
    with pytest.raises(StateError, match="subject 'a': this request took down") as refused:
        cohorts.create(HERE, new(["a"]))
    assert (refused.value.code, refused.value.facts["job"]) == ("job.parked", taken.id)


def test_a_cohort_is_taken_back_whole_and_then_removed(cohorts: Cohorts, jobs: Jobs, db: Database) -> None:
    cohort, members = cohorts.create(HERE, new("abc"))
    finish(jobs, begin(jobs, members[0]))
    running = begin(jobs, members[1])
    told = cohorts.dismiss(HERE, cohort.id)
    assert told is not None
    assert told.counts == {JobStatus.SUCCESSFUL: 1, JobStatus.RUNNING: 1, JobStatus.DISMISSED: 1}
    assert jobs.confirm_dismissed(running.id, running.lease_token)
    [summary] = summaries(db)
    assert cohorts.dismiss(HERE, cohort.id) is not None, "the summary still waits"
    assert jobs.get(HERE, summary).status is JobStatus.DISMISSED
    assert cohorts.dismiss(HERE, cohort.id) is None
    with pytest.raises(StateError, match="no cohort"):
        cohorts.get(HERE, cohort.id)
    assert jobs.list(HERE).items == ()


def test_what_is_foreign_is_not_there(cohorts: Cohorts, db: Database) -> None:
    stranger = WorkspaceId("strangers")
    Workspaces(db).create("strangers")
    cohort, _ = cohorts.create(HERE, new("a"))
    for act in (cohorts.get, cohorts.jobs, cohorts.dismiss, cohorts.retry):
        with pytest.raises(StateError) as refused:
            act(stranger, cohort.id)
        assert refused.value.code == "cohort.not_found"
    assert cohorts.list(stranger).items == ()


def test_lists_go_page_by_page(cohorts: Cohorts) -> None:
    ids = [cohorts.create(HERE, new("a"))[0].id for _ in range(3)]
    first = cohorts.list(HERE, limit=2)
    rest = cohorts.list(HERE, limit=2, cursor=first.next)
    assert [one.id for one in (*first.items, *rest.items)] == ids[::-1]
    assert rest.next is None


def test_a_cohort_goes_with_the_last_of_its_jobs(cohorts: Cohorts, jobs: Jobs, db: Database) -> None:
    def ended(cohort: Cohort, days: float) -> None:
        with db.session() as session:
            row = session.get_one(CohortRow, cohort.id)
            row.finished_at = db.now(session) - timedelta(days=days)
            of_it = (JobRow.cohort_id == cohort.id) | (JobRow.id == row.summary_job_id)
            for job in session.scalars(select(JobRow).where(of_it)):
                job.status, job.finished_at = JobStatus.DISMISSED, row.finished_at

    kept, gone = (cohorts.create(HERE, new("ab"))[0] for _ in range(2))
    for cohort, days in ((kept, 1.0), (gone, 10.0)):
        cohorts.dismiss(HERE, cohort.id)
        ended(cohort, days)
    Retention(db, RetentionPolicies(db, RetentionPolicy(5.0, 0.0, 0.0))).sweep()
    assert [one.id for one in cohorts.list(HERE).items] == [kept.id]
    with db.reading() as session:
        assert session.execute(select(func.count()).select_from(JobRow)).scalar_one() == 3
