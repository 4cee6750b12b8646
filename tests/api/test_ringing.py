"""The thread that announces accepted jobs: all of them, few transactions, and nothing is held up by a broker that is away."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import redis

from api.ringing import BELLS, Ringer
from store.database import Database
from store.doorbell import Doorbell
from store.group_commit import GroupCommit
from store.job import Job
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.valkey import ValkeyServer


@pytest.fixture
def jobs(tmp_path: Path) -> Iterator[Jobs]:
    database = Database(Settings(data_dir=tmp_path))
    database.migrate()
    yield Jobs(database)
    database.close()


def accepted(jobs: Jobs, count: int) -> list[Job]:
    return [jobs.create(DEFAULT_WORKSPACE, "validate", {}) for _ in range(count)]


def rung(jobs: Jobs) -> int:
    return sum(job.rung_at is not None for job in jobs.list(DEFAULT_WORKSPACE, limit=1000).items)


def test_everything_that_was_accepted_is_announced_before_the_end(jobs: Jobs, valkey: ValkeyServer) -> None:
    ringer = Ringer(Doorbell(valkey.url, "here"), jobs, GroupCommit(jobs._db))
    waiting = accepted(jobs, 30)
    for job in waiting:  # before it starts: they lie in one heap
        ringer.ring(job)
    ringer.start()
    ringer.stop()
    assert rung(jobs) == len(waiting)
    assert jobs.due_to_ring(60.0) == []


def test_bells_ring_at_once_and_are_marked_together_soon(jobs: Jobs, valkey: ValkeyServer) -> None:
    """A crowd of one moment needs no bell each: who hears one takes all he has room for."""
    ringer, broker = (
        Ringer(Doorbell(valkey.url, "here"), jobs, GroupCommit(jobs._db)),
        redis.Redis(unix_socket_path=str(valkey.socket_path)),
    )
    ringer.start()
    first = accepted(jobs, 1)[0]
    ringer.ring(first)
    heard = f"here.{first.queue.value}"
    assert wait_for(lambda: broker.llen(heard) == 1)
    assert wait_for(lambda: rung(jobs) == 1)
    crowd = accepted(jobs, BELLS + 10)
    late = Ringer(Doorbell(valkey.url, "here"), jobs, GroupCommit(jobs._db))
    for job in crowd:
        late.ring(job)
    late.start()
    late.stop()
    ringer.stop()
    assert rung(jobs) == len(crowd) + 1
    assert broker.llen(heard) == BELLS + 1
    broker.close()


def wait_for(reached: Callable[[], bool]) -> bool:
    deadline = time.monotonic() + 20
    while not reached() and time.monotonic() < deadline:
        time.sleep(0.02)
    return reached()


def test_a_job_that_was_taken_meanwhile_is_left_alone(jobs: Jobs, valkey: ValkeyServer) -> None:
    taken, waiting = accepted(jobs, 2)
    assert jobs.claim(taken.id, 1, "tests", 60.0) is not None
    jobs.mark_all_rung([(taken.id, 1), (waiting.id, 1)])
    assert jobs.get(DEFAULT_WORKSPACE, taken.id).rung_at is None
    assert jobs.get(DEFAULT_WORKSPACE, waiting.id).rung_at is not None


def test_a_broker_that_is_away_costs_one_attempt(jobs: Jobs, valkey: ValkeyServer) -> None:
    ringer = Ringer(Doorbell(valkey.url, "here"), jobs, GroupCommit(jobs._db))
    valkey.kill()
    for job in accepted(jobs, 50):
        ringer.ring(job)
    began = time.process_time()
    ringer.start()
    ringer.stop()
    assert rung(jobs) == 0
    assert len(jobs.due_to_ring(60.0)) == 50, "the reconciler has them all"
    assert time.process_time() - began < 5
    valkey.start()
    again = Ringer(Doorbell(valkey.url, "here"), jobs, GroupCommit(jobs._db))
    late = accepted(jobs, 1)[0]
    again.start()
    again.ring(late)
    again.stop()
    assert jobs.get(DEFAULT_WORKSPACE, late.id).rung_at is not None


def bells_of(valkey: ValkeyServer, queue: str) -> list[dict[str, object]]:
    broker = redis.Redis(unix_socket_path=str(valkey.socket_path))
    found = [json.loads(bell)["headers"] for bell in broker.lrange(queue, 0, -1)]
    broker.close()
    return found


def test_a_cohort_is_announced_as_one_group(jobs: Jobs, valkey: ValkeyServer) -> None:
    ringer = Ringer(Doorbell(valkey.url, "here"), jobs, GroupCommit(jobs._db))
    subjects = accepted(jobs, BELLS + 10)
    ringer.ring_cohort("cohort-1", subjects)
    ringer.ring_cohort("cohort-without-subjects", [])
    ringer.start()
    ringer.stop()
    bells = bells_of(valkey, f"here.{subjects[0].queue.value}")
    assert {bell["group"] for bell in bells} == {"cohort-1"}
    assert sorted(bell["group_index"] for bell in bells) == list(range(len(subjects)))
    assert rung(jobs) == len(subjects)
    assert jobs.due_to_ring(60.0) == []


def test_a_cohort_that_no_broker_took_is_left_to_the_reconciler(jobs: Jobs, valkey: ValkeyServer) -> None:
    ringer = Ringer(Doorbell(valkey.url, "here"), jobs, GroupCommit(jobs._db))
    valkey.kill()
    ringer.ring_cohort("cohort-1", accepted(jobs, 5))
    ringer.start()
    ringer.stop()
    assert rung(jobs) == 0
    assert len(jobs.due_to_ring(60.0)) == 5
