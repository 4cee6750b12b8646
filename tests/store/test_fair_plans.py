"""Whole days of a lab, played through on a real table: jobs of all sizes, workers of several hosts, crashes and dismissals.

Every plan is drawn from a seed by Hypothesis; a failure prints the plan that led to it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sqlalchemy import delete

from core.schema.expectation import Expectation, JobQueue
from store.choice import Room
from store.database import Database
from store.job import Job, JobStatus
from store.job_search import JobSearch
from store.jobs import Jobs
from store.records import JobRow, TurnRow
from store.workspace import WorkspaceId
from store.workspaces import Workspaces
from tests.store.samples import CRASHED, finish

GB = 10**9
WORKSPACES = tuple(WorkspaceId(name) for name in ("ada", "bob", "cy", "dot"))
HOSTS = {"large": 16 * GB, "small": 6 * GB}
SLOTS, FAST_SLOTS = 2, 1
JOB_BYTES = 8 * GB
ROUNDS = 400

Submission = tuple[int, int, bool]
submissions = st.tuples(st.integers(0, len(WORKSPACES) - 1), st.integers(1, 8), st.booleans())
plans = st.tuples(st.lists(submissions, min_size=1, max_size=14), st.lists(st.integers(0, 5), max_size=25))


@dataclass
class Lab:
    """What has happened so far."""

    jobs: Jobs
    accepted: set[str] = field(default_factory=set)
    claims: Counter[tuple[str, int]] = field(default_factory=Counter)
    running: list[Job] = field(default_factory=list)
    passed_over: Counter[str] = field(default_factory=Counter)

    def submit(self, plan: Submission) -> None:
        workspace, gb, is_fast = plan
        expectation = Expectation(gb * GB, 1.0 if is_fast else 600.0)
        self.accepted.add(self.jobs.create(WORKSPACES[workspace], "validate", {}, max_attempts=9, expectation=expectation).id)

    def look(self, host: str) -> Job | None:
        """As a worker's crew does: what it may take, and what it takes."""
        here = [job for job in self.running if str(job.lease_owner).startswith(host)]
        fast = sum(job.queue is JobQueue.FAST for job in here)
        free = frozenset(JobQueue) if len(here) < SLOTS else frozenset({JobQueue.FAST}) if fast < FAST_SLOTS else frozenset()
        room = Room(host, free, frozenset(JobQueue), HOSTS[host], JOB_BYTES, patience_s=1e9)
        waiting = {workspace for workspace in WORKSPACES if self.jobs.list(workspace, JobSearch(("accepted",))).items}
        job = self.jobs.claim_next(f"{host}:1", 3600.0, room)
        if job is None:
            return None
        self.claims[job.id, job.lease_token] += 1
        self.running.append(job)
        used = sum(other.expected_memory_bytes for other in (*here, job))
        assert used <= HOSTS[host], f"{used} bytes on {host}"
        if len(here) >= SLOTS:
            assert job.queue is JobQueue.FAST
        for workspace in waiting - {job.workspace}:
            self.passed_over[workspace] += 1
        self.passed_over[job.workspace] = 0
        return job

    def end(self, position: int, how: int) -> None:
        """The job at work for the (position)th time ends: mostly well, sometimes by a crash, a lost worker or a dismissal."""
        job = self.running.pop(position % len(self.running))
        if how == 0:
            again = self.jobs.fail(job.id, job.lease_token, CRASHED, retry=True)
            assert again is not None
            assert again.status is JobStatus.ACCEPTED
        elif how == 1:
            self.jobs.release(job.id, job.lease_token)
        elif how == 2:
            self.jobs.dismiss(job.workspace, job.id)
            assert self.jobs.confirm_dismissed(job.id, job.lease_token)
        else:
            assert finish(self.jobs, job)
        assert not finish(self.jobs, replace(job, lease_token=job.lease_token + 1))


def test_any_plan_ends_with_every_job_done_once_and_nobody_left_waiting(db: Database) -> None:
    for name in WORKSPACES:
        Workspaces(db).create(name)

    @settings(max_examples=8, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))
    @given(plan=plans)
    def play(plan: tuple[list[Submission], list[int]]) -> None:
        with db.session() as session:
            session.execute(delete(JobRow))
            session.execute(delete(TurnRow))
        first, endings = plan
        lab = Lab(Jobs(db))
        half = len(first) // 2 + 1
        for one in first[:half]:
            lab.submit(one)
        late, how = list(first[half:]), list(endings)
        for number in range(ROUNDS):
            while any(lab.look(host) is not None for host in HOSTS):
                pass
            if late:
                lab.submit(late.pop())
            elif not lab.running:
                break
            if lab.running:
                lab.end(number, how.pop() if how else 5)
        ended = [job for workspace in WORKSPACES for job in lab.jobs.list(workspace).items]
        assert {job.id for job in ended} == lab.accepted, "no job is lost"
        assert {job.status for job in ended} <= {JobStatus.SUCCESSFUL, JobStatus.DISMISSED}
        assert set(lab.claims.values()) <= {1}, "no attempt is claimed twice"

    play()


def test_no_workspace_waits_for_more_turns_than_there_are_others(db: Database) -> None:
    """One worker, one job at a time, all of a size: whoever waits is served within one round of all workspaces."""
    jobs = Jobs(db)
    for name in WORKSPACES:
        Workspaces(db).create(name)
    room = Room("one", frozenset(JobQueue), frozenset(JobQueue), 16 * GB, JOB_BYTES, patience_s=1e9)

    @settings(max_examples=8, deadline=None, derandomize=True, database=None, suppress_health_check=list(HealthCheck))
    @given(st.lists(st.integers(0, len(WORKSPACES) - 1), min_size=4, max_size=20))
    def play(order: list[int]) -> None:
        with db.session() as session:
            session.execute(delete(JobRow))
            session.execute(delete(TurnRow))
        waiting: Counter[str] = Counter()
        passed: Counter[str] = Counter()
        for step, number in enumerate(order):
            jobs.create(WORKSPACES[number], "validate", {}, expectation=Expectation(GB, 600.0))
            waiting[WORKSPACES[number]] += 1
            if step % 2:  # twice as many come as go
                job = jobs.claim_next("one:1", 30.0, room)
                assert job is not None
                finish(jobs, job)
                waiting[job.workspace] -= 1
                passed[job.workspace] = 0
                for name in WORKSPACES:
                    passed[name] += waiting[name] > 0 and name != job.workspace
                    assert passed[name] < len(WORKSPACES), f"{name} was passed over {passed[name]} times"

    play()


def test_a_large_job_is_served_though_small_ones_never_end(db: Database) -> None:
    """Small jobs keep three quarters of the host busy for ever; the large one needs half of it."""
    jobs = Jobs(db)
    for name in WORKSPACES:
        Workspaces(db).create(name)
    room = Room("one", frozenset(JobQueue), frozenset(JobQueue), 16 * GB, JOB_BYTES, patience_s=0.0)
    running = []
    for _ in range(3):
        jobs.create(WORKSPACES[0], "validate", {}, expectation=Expectation(4 * GB, 600.0))
        running.append(jobs.claim_next("one:1", 30.0, room))
    large = jobs.create(WORKSPACES[1], "validate", {}, expectation=Expectation(8 * GB, 600.0))
    assert large.queued_at < datetime.now(UTC) + timedelta(seconds=1)
    served_after = 0
    while True:
        for _ in range(2):
            jobs.create(WORKSPACES[2], "validate", {}, expectation=Expectation(4 * GB, 600.0))
        job = jobs.claim_next("one:1", 30.0, room)
        if job is not None and job.id == large.id:
            break
        if job is not None:
            running.append(job)
        ended = running.pop(0)
        assert ended is not None
        finish(jobs, ended)
        served_after += 1
        assert served_after < 5
