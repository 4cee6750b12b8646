"""A cohort on two real workers, one of them killed midway, and on a broker that forgets: nobody is lost or comes twice."""

from __future__ import annotations

import time

from sqlalchemy import select

from core.schema.cohort import COHORT_SUMMARY
from core.schema.expectation import Expectation
from store.cohort import Cohort
from store.cohorts import Cohorts, NewCohort, NewSubject
from store.job import Job, JobStatus
from store.records import JobRow
from store.workspace import DEFAULT_WORKSPACE
from tests.valkey import ValkeyServer
from tests.worker.conftest import LIMIT_S, Service
from tests.worker.test_lost_workers import kill_owner

SUBJECTS = 10
MOST = 9  # attempts: where the machine is slow, living workers lose their short leases, too
PATIENCE_S = 4 * LIMIT_S
NEED = Expectation(memory_bytes=10**6, cpu_s=1.0)


def accepted(service: Service, seconds: float) -> tuple[Cohort, tuple[Job, ...]]:
    subjects = [NewSubject(f"s{number}", {"act": "sleep", "seconds": seconds}, (), NEED) for number in range(SUBJECTS)]
    cohort, jobs = Cohorts(service.db, service.jobs).create(
        DEFAULT_WORKSPACE, NewCohort("validate", {}, subjects), max_attempts=MOST
    )
    assert service.doorbell.ring_all(cohort.id, [(job.id, job.attempt, job.queue) for job in jobs])
    service.jobs.mark_all_rung((job.id, job.attempt) for job in jobs)
    return cohort, jobs


def ended(service: Service, cohort: Cohort) -> Job:
    """The summary, when it has ended."""
    cohorts, deadline = Cohorts(service.db, service.jobs), time.monotonic() + PATIENCE_S
    while (summary := cohorts.get(DEFAULT_WORKSPACE, cohort.id).summary_job_id) is None:
        assert time.monotonic() < deadline, service.log()
        time.sleep(0.05)
    return service.wait(service.jobs.get(DEFAULT_WORKSPACE, summary), limit_s=PATIENCE_S)


def summaries(service: Service) -> list[str]:
    with service.db.reading() as session:
        return list(session.scalars(select(JobRow.id).where(JobRow.process == COHORT_SUMMARY)))


def ends_told(service: Service, job: Job) -> int:
    return sum(event.type == "done" for event in service.events.after(DEFAULT_WORKSPACE, job.id))


def test_a_killed_worker_loses_no_subject_and_doubles_none(service: Service) -> None:
    service.start_worker()
    service.start_worker()
    cohort, jobs = accepted(service, 0.5)
    service.wait(jobs[1], limit_s=PATIENCE_S)
    victim = next(job for job in jobs if service.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.RUNNING)
    kill_owner(service, victim)
    summary = ended(service, cohort)
    done = [service.jobs.get(DEFAULT_WORKSPACE, job.id) for job in jobs]
    assert [job.status for job in (*done, summary)] == [JobStatus.SUCCESSFUL] * (SUBJECTS + 1)
    assert [ends_told(service, job) for job in jobs] == [1] * SUBJECTS
    assert any(job.attempt > 1 for job in done)
    assert summaries(service) == [summary.id]
    assert {one["status"] for one in summary.inputs["subjects"]} == {"successful"}
    assert len(summary.mesh_inputs) == SUBJECTS


def test_a_broker_that_forgets_the_bells_loses_no_subject(service: Service, valkey: ValkeyServer) -> None:
    cohort, jobs = accepted(service, 0.0)
    valkey.kill()
    valkey.start()
    service.start_worker()
    summary = ended(service, cohort)
    assert summary.status is JobStatus.SUCCESSFUL
    assert [ends_told(service, job) for job in jobs] == [1] * SUBJECTS
    assert summaries(service) == [summary.id]


def test_a_broker_that_loses_everything_midway_loses_no_subject(service: Service, valkey: ValkeyServer) -> None:
    """What is left of the group goes with it; the job table has the rest."""
    service.start_worker()
    cohort, jobs = accepted(service, 0.2)
    service.wait(jobs[1], limit_s=PATIENCE_S)
    valkey.kill()
    valkey.start()
    assert any(service.jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.ACCEPTED for job in jobs)
    service.start_worker()
    summary = ended(service, cohort)
    assert summary.status is JobStatus.SUCCESSFUL
    assert [ends_told(service, job) for job in jobs] == [1] * SUBJECTS
    assert summaries(service) == [summary.id]
