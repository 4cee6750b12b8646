"""The doorbell against a real Valkey: what is in the message, and what happens when nobody answers."""

from __future__ import annotations

import base64
import json
import signal
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import quote

import pytest
import redis

from core.schema.expectation import JobQueue
from store.doorbell import Doorbell
from tests.valkey import ValkeyServer

JOB = "6f1f2f6e-3b0a-4b5e-9d0f-0123456789ab"


def waiting(valkey: ValkeyServer, queue: str = "jobs") -> list[dict[str, Any]]:
    """The messages in a queue, newest first."""
    with redis.Redis(unix_socket_path=str(valkey.socket_path)) as client:
        return [json.loads(message) for message in client.lrange(queue, 0, -1)]


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    start = time.monotonic()
    yield
    assert time.monotonic() - start < seconds


@pytest.fixture
def doorbell(valkey: ValkeyServer) -> Iterator[Doorbell]:
    bell = Doorbell(valkey.url)
    yield bell
    bell.close()


def test_the_message_carries_id_and_attempt_only(valkey: ValkeyServer, doorbell: Doorbell) -> None:
    assert doorbell.ring(JOB, 2) is True
    (message,) = waiting(valkey)
    args, kwargs, _ = json.loads(base64.b64decode(message["body"]))
    assert (message["headers"]["task"], message["content-type"]) == ("jobs.run", "application/json")
    assert (args, kwargs) == ([], {"job_id": JOB, "attempt": 2})
    assert message["headers"]["eta"] is None


def test_a_cohort_rings_as_one_canvas(valkey: ValkeyServer, doorbell: Doorbell) -> None:
    """A bell each, in the queue of each job, all of one group; the group has no result that could be lost."""
    bells = [(f"{JOB[:-1]}{number}", 1, queue) for number, queue in enumerate((JobQueue.FAST, JobQueue.HEAVY, JobQueue.FAST))]
    assert doorbell.ring_all("a-cohort", bells) is True
    fast, heavy = waiting(valkey, "jobs.fast"), waiting(valkey, "jobs.heavy")
    assert [message["headers"]["group"] for message in fast + heavy] == ["a-cohort"] * 3
    told = [json.loads(base64.b64decode(message["body"]))[1:] for message in (fast[1], heavy[0], fast[0])]
    assert [kwargs["job_id"] for kwargs, _ in told] == [job for job, _, _ in bells]
    assert all(embed["chord"] is None for _, embed in told)
    with redis.Redis(unix_socket_path=str(valkey.socket_path)) as client:
        assert client.keys("celery-task*") == []


def test_a_canvas_for_a_broker_that_is_away(valkey: ValkeyServer, doorbell: Doorbell) -> None:
    valkey.kill()
    assert doorbell.ring_all("a-cohort", [(JOB, 1, JobQueue.FAST)]) is False


def test_the_queue_can_be_named(valkey: ValkeyServer) -> None:
    bell = Doorbell(valkey.url, queue="heavy")
    assert bell.ring(JOB, 1)
    bell.close()
    assert (len(waiting(valkey, "heavy")), len(waiting(valkey, "jobs"))) == (1, 0)


def test_fast_and_heavy_jobs_are_told_to_their_own_workers(valkey: ValkeyServer, doorbell: Doorbell) -> None:
    for queue in JobQueue:
        assert doorbell.ring(JOB, 1, queue)
    assert [len(waiting(valkey, name)) for name in ("jobs.fast", "jobs.heavy", "jobs")] == [1, 1, 0]


def test_a_quoted_path_with_a_database_number_works(valkey: ValkeyServer) -> None:
    bell = Doorbell(f"redis+socket://{quote(str(valkey.socket_path))}?virtual_host=0")
    assert bell.ring(JOB, 1)
    assert bell.is_answered()
    bell.close()
    assert len(waiting(valkey)) == 1


def test_nobody_there_is_no_error_and_no_wait(valkey: ValkeyServer, doorbell: Doorbell) -> None:
    assert doorbell.ring(JOB, 1)
    valkey.kill()
    for _ in range(3):
        with at_most(2.0):
            assert doorbell.ring(JOB, 1) is False
    valkey.start()
    assert doorbell.ring(JOB, 1) is True
    assert len(waiting(valkey)) == 1


def test_a_broker_that_restarted_unnoticed_is_no_obstacle(valkey: ValkeyServer, doorbell: Doorbell) -> None:
    assert doorbell.ring(JOB, 1)
    valkey.kill()
    valkey.start()
    assert doorbell.ring(JOB, 2)
    assert len(waiting(valkey)) == 1


def test_a_broker_that_hangs_costs_a_second(valkey: ValkeyServer, doorbell: Doorbell) -> None:
    assert doorbell.ring(JOB, 1)
    valkey.signal(signal.SIGSTOP)
    with at_most(3.0):
        assert doorbell.ring(JOB, 1) is False
    valkey.signal(signal.SIGCONT)
    assert doorbell.ring(JOB, 1) is True


def test_whether_the_broker_answers(valkey: ValkeyServer, doorbell: Doorbell) -> None:
    assert doorbell.is_answered() is True
    valkey.signal(signal.SIGSTOP)
    with at_most(4.0):
        assert doorbell.is_answered() is False
    valkey.signal(signal.SIGCONT)
    assert doorbell.is_answered() is True
    valkey.kill()
    with at_most(2.0):
        assert doorbell.is_answered() is False


def test_something_else_on_the_port_is_no_broker() -> None:
    with socket.create_server(("127.0.0.1", 0)) as deaf:
        bell = Doorbell(f"redis://127.0.0.1:{deaf.getsockname()[1]}/0")
        with at_most(4.0):
            assert bell.ring(JOB, 1) is False
        bell.close()


def test_ringing_is_cheap(doorbell: Doorbell) -> None:
    doorbell.ring(JOB, 1)
    with at_most(5.0):
        assert all(doorbell.ring(JOB, attempt) for attempt in range(200))
