"""Who gets the next worker, on both databases."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import timedelta

import pytest
from sqlalchemy import update

from core.schema.expectation import Expectation, JobQueue
from store.choice import Room
from store.database import Database
from store.job import Job, JobStatus
from store.job_search import JobSearch
from store.jobs import Jobs
from store.records import JobRow
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces
from tests.store.samples import CRASHED, finish

GB = 10**9
BOTH = frozenset(JobQueue)
FAST_ONLY = frozenset({JobQueue.FAST})
ROOM = Room("host-a", BOTH, BOTH, memory_bytes=16 * GB, job_memory_bytes=8 * GB, patience_s=60.0)
ADA, BOB, CY = WorkspaceId("ada"), WorkspaceId("bob"), WorkspaceId("cy")

Submit = Callable[..., Job]


@pytest.fixture
def submit(db: Database, jobs: Jobs) -> Submit:
    """Accept a job of an expected size and queue; the workspaces are there."""
    for name in (ADA, BOB, CY):
        Workspaces(db).create(name)

    def accept(workspace: WorkspaceId = ADA, gb: float = 1.0, queue: JobQueue = JobQueue.HEAVY) -> Job:
        cpu_s = 1.0 if queue is JobQueue.FAST else 600.0
        return jobs.create(workspace, "validate", {}, expectation=Expectation(int(gb * GB), cpu_s))

    return accept


def take(jobs: Jobs, room: Room = ROOM, pid: int = 1) -> Job | None:
    return jobs.claim_next(f"{room.host}:{pid}", 30.0, room)


def age(db: Database, job: Job, by_s: float) -> None:
    with db.session() as session:
        session.execute(update(JobRow).where(JobRow.id == job.id).values(queued_at=job.queued_at - timedelta(seconds=by_s)))


def test_nothing_waits(jobs: Jobs) -> None:
    assert take(jobs) is None


def test_the_job_is_claimed_like_any_other(jobs: Jobs, submit: Submit) -> None:
    waiting = submit()
    job = take(jobs)
    assert job is not None
    assert (job.id, job.status, job.lease_owner, job.lease_token, job.attempt) == (waiting.id, "running", "host-a:1", 1, 1)
    assert jobs.get(ADA, job.id) == job
    assert take(jobs) is None
    assert finish(jobs, job)


def test_workspaces_take_turns_however_much_one_has_sent(jobs: Jobs, submit: Submit) -> None:
    many = [submit(ADA) for _ in range(6)]
    few = [submit(BOB) for _ in range(2)]
    order = []
    while (job := take(jobs)) is not None:
        order.append(job.id)
        finish(jobs, job)
    assert order == [many[0].id, few[0].id, many[1].id, few[1].id, *(job.id for job in many[2:])]


def test_who_has_fewer_jobs_under_way_goes_first(jobs: Jobs, submit: Submit) -> None:
    for workspace in (ADA, ADA, BOB, BOB, BOB, CY):
        submit(workspace)
    taken = [take(jobs) for _ in range(6)]
    assert [job.workspace for job in taken if job is not None] == [ADA, BOB, CY, ADA, BOB, BOB]


def test_removing_finished_jobs_wins_no_turn(jobs: Jobs, submit: Submit) -> None:
    for workspace in (ADA, ADA, BOB):
        submit(workspace)
    first = take(jobs)
    assert first is not None
    finish(jobs, first)
    jobs.dismiss(ADA, first.id)
    second = take(jobs)
    assert second is not None
    assert (first.workspace, second.workspace) == (ADA, BOB)


def test_within_a_workspace_who_came_first_goes_first_in_both_queues(jobs: Jobs, submit: Submit) -> None:
    made = [submit(queue=queue) for queue in (JobQueue.HEAVY, JobQueue.FAST, JobQueue.HEAVY, JobQueue.FAST)]
    taken = [take(jobs) for _ in made]
    assert [job and job.id for job in taken] == [job.id for job in made]


def test_a_slot_for_fast_jobs_takes_no_other(jobs: Jobs, submit: Submit) -> None:
    submit(queue=JobQueue.HEAVY)
    fast = submit(BOB, queue=JobQueue.FAST)
    reserved = replace(ROOM, free=FAST_ONLY)
    job = take(jobs, reserved)
    assert job is not None
    assert job.id == fast.id
    assert take(jobs, reserved) is None
    assert take(jobs, replace(ROOM, free=frozenset())) is None


def test_memory_is_that_of_the_host_whichever_process_uses_it(jobs: Jobs, submit: Submit) -> None:
    for _ in range(4):
        submit(gb=6)
    assert take(jobs, pid=1) is not None
    assert take(jobs, pid=2) is not None
    assert take(jobs, pid=3) is None, "12 of 16 GB are taken"
    other = replace(ROOM, host="host-b")
    job = take(jobs, other)
    assert job is not None
    finish(jobs, job)
    assert take(jobs, other) is not None
    assert jobs.list(ADA, JobSearch(("accepted",))).items == ()


def test_what_does_not_fit_lets_others_pass_until_its_patience_ends(db: Database, jobs: Jobs, submit: Submit) -> None:
    running = [submit(gb=5, queue=JobQueue.HEAVY), submit(gb=5, queue=JobQueue.HEAVY)]
    assert [take(jobs) is not None for _ in running] == [True, True]  # 6 of 16 GB are free
    large = submit(BOB, gb=8)
    small = [submit(CY, gb=2) for _ in range(3)]
    first = take(jobs)
    assert first is not None
    assert first.id == small[0].id
    finish(jobs, first)

    age(db, large, 61)
    fast = [submit(ADA, gb=5, queue=JobQueue.FAST), submit(ADA, gb=5, queue=JobQueue.FAST)]
    beside = take(jobs)
    assert beside is not None
    assert beside.id == fast[0].id, "no heavy one any more, and of the fast ones what fits beside the one that waits"
    assert take(jobs) is None
    for job in jobs.list(ADA, JobSearch(("running",))).items:
        if job.id != beside.id:
            finish(jobs, job)
    now = take(jobs)
    assert now is not None
    assert now.id == large.id


def test_a_job_no_host_of_this_size_can_hold_stops_nobody(db: Database, jobs: Jobs, submit: Submit) -> None:
    small_host = replace(ROOM, memory_bytes=4 * GB)
    age(db, submit(gb=7), 3600)
    fits = submit(gb=2)
    job = take(jobs, small_host)
    assert job is not None
    assert job.id == fits.id


def test_no_job_is_counted_with_more_than_it_may_use(jobs: Jobs, submit: Submit) -> None:
    submit(gb=50)
    submit(gb=50)
    assert take(jobs) is not None  # at 8 GB its child is ended
    assert take(jobs) is not None
    submit(gb=0.1)
    assert take(jobs) is None


def test_a_retried_attempt_keeps_its_place_and_counts(jobs: Jobs, submit: Submit) -> None:
    first, second = submit(), submit()
    job = take(jobs)
    assert job is not None
    jobs.fail(job.id, job.lease_token, CRASHED, retry=True)
    taken = [take(jobs), take(jobs)]
    assert [(job.id, job.attempt) for job in taken if job is not None] == [(first.id, 2), (second.id, 1)]


def test_positions_are_the_order_in_which_jobs_are_taken(jobs: Jobs, submit: Submit) -> None:
    for workspace in (CY, CY, ADA):
        submit(workspace)
    assert [job.workspace for job in (take(jobs), take(jobs), take(jobs)) if job is not None] == [CY, ADA, CY]
    made = [
        submit(workspace, queue=queue)
        for workspace, queue in [
            (ADA, JobQueue.HEAVY),
            (ADA, JobQueue.FAST),
            (ADA, JobQueue.HEAVY),
            (BOB, JobQueue.HEAVY),
            (BOB, JobQueue.FAST),
            (CY, JobQueue.FAST),
            (CY, JobQueue.HEAVY),
            (BOB, JobQueue.HEAVY),
        ]
    ]

    def check(queue: JobQueue, room: Room) -> None:
        told = {job.id: jobs.queue_position(job.workspace, job.id) for job in made if job.queue is queue}
        order = []
        while (job := take(jobs, room)) is not None:
            order.append(job)
        assert told == {job.id: place for place, job in enumerate(order, 1) if job.queue is queue}

    check(JobQueue.FAST, replace(ROOM, free=FAST_ONLY))
    submit(BOB, queue=JobQueue.FAST)
    check(JobQueue.HEAVY, ROOM)


def test_racing_workers_share_no_job_and_no_memory(settings: Settings, jobs: Jobs, submit: Submit) -> None:
    """Eight threads with connections of their own, on two hosts: 24 jobs of 5 GB, three at a time fit each host."""
    made = [submit(workspace, gb=5) for workspace in (ADA, BOB, CY) for _ in range(8)]

    def work(number: int) -> list[tuple[str, str]]:
        database = Database(settings)
        table, room = Jobs(database), replace(ROOM, host=f"host-{number % 2}")
        done, idle = [], 0
        while idle < 200 and len(done) < len(made):
            job = take(table, room, number)
            if job is None:
                idle += 1
                if not table.list(ADA, JobSearch(("accepted",))).items + table.list(CY, JobSearch(("accepted",))).items:
                    break
                continue
            here = [
                other
                for name in (ADA, BOB, CY)
                for other in table.list(name, JobSearch(("running",))).items
                if str(other.lease_owner).startswith(room.host)
            ]
            assert len(here) <= 3, here
            done.append((job.id, job.workspace))
            assert finish(table, job)
        database.close()
        return done

    with ThreadPoolExecutor(8) as pool:
        done = [one for part in pool.map(work, range(8)) for one in part]
    while (job := take(jobs)) is not None:  # what nobody waited for
        done.append((job.id, job.workspace))
        finish(jobs, job)
    assert Counter(job_id for job_id, _ in done) == Counter(job.id for job in made)
    assert {jobs.get(job.workspace, job.id).status for job in made} == {JobStatus.SUCCESSFUL}
    assert jobs.list(DEFAULT_WORKSPACE).items == ()
