"""Slots, bells and memory of one worker, with jobs that are nothing but a wait; the table is real."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import text

from core.schema.expectation import Expectation, JobQueue
from store.job import Job
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import finish
from tests.valkey import ValkeyServer
from tests.worker.conftest import make_settings
from worker.closing import Closing
from worker.crew import Crew
from worker.workshop import Workshop

MIB = 1024**2
LIMIT_S = 20.0


class Scene:
    """A crew whose jobs end when the test says so."""

    def __init__(self, workshop: Workshop) -> None:
        self.workshop = workshop
        self._stores_by_hand = False
        self._stores: dict[str, threading.Event] = {}
        self.begun: list[Job] = []
        self._ends: dict[str, threading.Event] = {}
        self.crew = Crew(workshop, self._work)

    def _work(self, workshop: Workshop, job: Job, leave: Callable[[], None]) -> None:
        self._ends[job.id], self._stores[job.id] = threading.Event(), threading.Event()
        if not self._stores_by_hand:
            self._stores[job.id].set()
        self.begun.append(job)
        assert self._ends[job.id].wait(LIMIT_S)
        leave()
        assert self._stores[job.id].wait(LIMIT_S)
        finish(workshop.jobs, job)

    def submit(self, queue: JobQueue = JobQueue.HEAVY, mib: int = 10) -> Job:
        cpu_s = 1.0 if queue is JobQueue.FAST else 600.0
        return self.workshop.jobs.create(DEFAULT_WORKSPACE, "validate", {}, expectation=Expectation(mib * MIB, cpu_s))

    def end(self, job: Job) -> None:
        self._ends[job.id].set()

    def hold_results(self) -> None:
        """From now on the results of a job are stored by `store` alone."""
        self._stores_by_hand = True

    def store(self, job: Job) -> None:
        self._stores[job.id].set()

    def await_begun(self, *jobs: Job) -> None:
        """Exactly these are begun, in whatever order."""
        wanted = {job.id for job in jobs}
        until(lambda: {job.id for job in self.begun} >= wanted)
        time.sleep(0.1)  # whoever is too many would come now
        assert {job.id for job in self.begun} == wanted


def until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.fixture
def make_scene(tmp_path: Path) -> Iterator[Callable[..., Scene]]:
    scenes: list[Scene] = []

    def make(**changes: Any) -> Scene:
        settings = make_settings(tmp_path, ValkeyServer(tmp_path), **changes)
        workshop = replace(Workshop.open(settings, target="tests.worker.targets:run"), closing=Closing(drain_s=0))
        workshop.db.migrate()
        scenes.append(Scene(workshop))
        scenes[-1].crew.start()
        return scenes[-1]

    yield make
    for scene in scenes:
        scene.workshop.closing.begin()
        for job in scene.begun:
            scene.end(job)
            scene.store(job)
        scene.crew.drain()
        scene.workshop.close()


def test_heavy_jobs_leave_a_slot_to_fast_ones(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene()
    heavy = [scene.submit() for _ in range(3)]
    scene.crew.ring()
    scene.await_begun(*heavy[:2])
    fast = [scene.submit(JobQueue.FAST) for _ in range(2)]
    scene.crew.ring()
    scene.await_begun(*heavy[:2], fast[0])
    assert scene.crew.free_queues() == frozenset()
    scene.end(fast[0])  # nobody rings
    scene.await_begun(*heavy[:2], *fast)
    scene.end(heavy[0])
    scene.end(fast[1])
    scene.await_begun(*heavy, *fast)


def test_fast_jobs_alone_take_no_more_than_the_slots(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene()
    fast = [scene.submit(JobQueue.FAST) for _ in range(4)]
    threading.Thread(target=scene.crew.ring).start()
    scene.await_begun(*fast[:2])


def test_a_bell_that_cannot_be_answered_here_waits_for_room(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene(worker_concurrency=1, worker_fast_slots=0)
    first, second = scene.submit(), scene.submit()
    scene.crew.ring()
    scene.await_begun(first)
    heard = threading.Thread(target=scene.crew.ring)
    heard.start()
    heard.join(0.3)
    assert heard.is_alive(), "Celery takes no further bell meanwhile, other hosts do"
    scene.end(first)
    scene.await_begun(first, second)
    scene.workshop.closing.begin()
    heard.join(LIMIT_S)
    assert not heard.is_alive()


def test_memory_that_gets_free_is_used_without_a_bell(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene(worker_memory_bytes=400 * MIB)
    first, second = scene.submit(mib=300), scene.submit(mib=200)
    scene.crew.ring()
    scene.await_begun(first)
    scene.end(first)
    scene.await_begun(first, second)


def test_nobody_need_ring(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene(look_s=0.1)
    job = scene.submit()
    scene.await_begun(job)


def test_a_worker_of_one_queue_leaves_the_other_alone(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene(worker_queues="fast")
    scene.submit()
    fast = scene.submit(JobQueue.FAST)
    scene.crew.ring()
    scene.await_begun(fast)


def test_a_crew_told_to_stop_claims_nothing_and_lets_its_jobs_end(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene()
    job = scene.submit()
    scene.crew.ring()
    scene.await_begun(job)
    scene.workshop.closing.begin()
    late = scene.submit()
    scene.crew.ring()
    drained = threading.Thread(target=scene.crew.drain)
    drained.start()
    drained.join(0.3)
    assert drained.is_alive()
    scene.end(job)
    drained.join(LIMIT_S)
    assert not drained.is_alive()
    assert scene.workshop.jobs.get(DEFAULT_WORKSPACE, job.id).status == "successful"
    assert scene.workshop.jobs.get(DEFAULT_WORKSPACE, late.id).status == "accepted"


def test_a_table_that_is_away_for_a_look_costs_nothing(make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch) -> None:
    scene = make_scene(look_s=0.1)
    with scene.workshop.db.session() as session:
        session.execute(text("ALTER TABLE turns RENAME TO turned"))
    job = scene.submit()
    time.sleep(0.4)
    assert scene.begun == []
    with scene.workshop.db.session() as session:
        session.execute(text("ALTER TABLE turned RENAME TO turns"))
    scene.await_begun(job)


def test_on_a_nearly_full_disk_no_job_is_taken(make_scene: Callable[..., Scene], caplog: pytest.LogCaptureFixture) -> None:
    scene = make_scene(disk_floor_bytes=2**60)
    scene.submit()
    scene.crew.ring()
    until(lambda: "no job is taken" in caplog.text)
    time.sleep(0.3)
    assert scene.begun == []


def test_the_next_job_begins_while_results_are_stored_but_no_more_than_compute(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene(worker_concurrency=1, worker_fast_slots=0)
    scene.hold_results()
    jobs = [scene.submit() for _ in range(3)]
    scene.crew.ring()
    scene.await_begun(jobs[0])
    scene.end(jobs[0])
    scene.await_begun(*jobs[:2])
    scene.end(jobs[1])
    scene.await_begun(*jobs[:2])  # two wait for the store: a third would only join them
    scene.store(jobs[0])
    scene.await_begun(*jobs)
