"""A real worker gives word, says goodbye, and folds what was counted."""

from __future__ import annotations

import signal
import socket
import threading
import time
from collections.abc import Callable

import pytest
from sqlalchemy import func, select

from core.errors import InternalError
from store.crew_records import TallyRow
from store.metrics import Metrics
from store.periodic import Periodic
from store.tally import Cell
from store.version import SERVER_VERSION
from store.workers import Workers, WorkerState
from tests.worker.conftest import Service


def until(condition: Callable[[], object], service: Service) -> None:
    deadline = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < deadline, service.log()
        time.sleep(0.05)


def unfolded(service: Service) -> int:
    with service.db.reading() as session:
        return session.execute(select(func.count()).select_from(TallyRow)).scalar_one()


def test_a_worker_is_there_until_it_says_goodbye(service: Service) -> None:
    workers = Workers(service.db, service.settings)
    service.start_worker()
    until(workers.served_queues, service)
    job = service.wait(service.submit("write"))
    (one,) = workers.list()
    assert one.word.host == socket.gethostname()
    assert one.word.name.startswith(f"{one.word.host}:")
    assert (one.word.version, one.word.concurrency) == (SERVER_VERSION, service.settings.worker_concurrency)
    assert min(one.word.memory_bytes, one.word.disk_free_bytes) > 0
    assert one.word.queues == service.settings.worker_queues
    assert one.state is WorkerState.ALIVE
    until(lambda: unfolded(service) == 0, service)
    cells = Metrics(service.db).read()
    assert cells[Cell("integument_jobs_ended_total", (job.process, "successful"))] == 1
    assert cells[Cell("integument_job_attempts_total", (job.process,))] == 1
    assert service.stop_workers() == [0]
    assert workers.list() == []


def test_one_that_is_killed_is_missed(service: Service) -> None:
    workers = Workers(service.db, service.settings)
    service.start_worker()
    until(workers.served_queues, service)
    service.stop_workers(signal.SIGKILL)
    (lost,) = workers.list()
    assert lost.state is WorkerState.ALIVE, "nobody can know yet"
    until(lambda: workers.list()[0].state is WorkerState.LOST, service)


def test_a_round_that_fails_is_followed_by_the_next(caplog: pytest.LogCaptureFixture) -> None:
    rounds: list[int] = []
    enough = threading.Event()

    def act() -> None:
        rounds.append(len(rounds))
        if len(rounds) == 1:
            raise InternalError("database.unavailable", "away")
        if len(rounds) == 2:
            raise RuntimeError("on purpose")
        enough.set()

    periodic = Periodic("rounds", act, 0.01)
    periodic.start()
    assert enough.wait(10)
    periodic.stop()
    assert "rounds waits: away" in caplog.text
    assert "rounds stumbled and goes on" in caplog.text
    seen = len(rounds)
    time.sleep(0.05)
    assert len(rounds) == seen
