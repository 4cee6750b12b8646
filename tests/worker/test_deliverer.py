"""Callbacks from the change of a job to a real receiver: the schedule, the death of a deliverer, an absent database."""

from __future__ import annotations

import json
import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator
from datetime import timedelta
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import select, update
from standardwebhooks.webhooks import Webhook

from core.errors import InternalError
from store.callback import Callback, CallbackState, Subscriber
from store.callbacks import Callbacks
from store.database import Database
from store.job import Job
from store.jobs import Jobs
from store.receivers import Receivers
from store.records import CallbackRow
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.valkey import ValkeyServer
from tests.worker.conftest import Service, make_settings
from tests.worker.receiver import Receiver, receiving
from worker.callback_sender import CallbackSender
from worker.deliverer import DELAYS_S, HOUR_S, LEASE_S, Deliverer, add_jitter

SECRET = "whsec_" + "c2VzYW1l" * 4
LOOPBACK = ("127.0.0.1",)


@pytest.fixture
def receiver() -> Iterator[Receiver]:
    with receiving() as receiver:
        yield receiver


class Outbox:
    """A job table with jobs somebody wants to hear of."""

    def __init__(self, settings: Settings, receiver: Receiver) -> None:
        self.settings = settings
        self.db = Database(settings)
        self.db.migrate()
        self.jobs = Jobs(self.db)
        self.callbacks = Callbacks(self.db)
        self.receiver = receiver

    def fail_job(self) -> Job:
        """One callback, `failed`."""
        subscriber = Subscriber("http://127.0.0.1:8000/", self.receiver.url, None, self.receiver.url)
        waiting = self.jobs.create(DEFAULT_WORKSPACE, "validate", {}, subscriber=subscriber, max_attempts=1)
        job = self.jobs.claim(waiting.id, 1, "tests", 30.0)
        assert job is not None
        (ended,) = self.jobs.expire_all_leases()
        return ended

    def only(self, job: Job) -> Callback:
        (callback,) = self.callbacks.of_job(DEFAULT_WORKSPACE, job.id)
        return callback

    def let_time_pass(self) -> float:
        """Until the callback is due; returns for how long that would have been, in s."""
        with self.db.session() as session:
            now = self.db.now(session)
            due: Any = session.execute(select(CallbackRow.due_at)).scalar_one()
            session.execute(update(CallbackRow).values(due_at=now))
            return float((due - now).total_seconds())

    def let_lease_run_out(self) -> None:
        with self.db.session() as session:
            session.execute(update(CallbackRow).values(lease_until=self.db.now(session) - timedelta(seconds=1)))

    def deliverer(self, **more: Any) -> Deliverer:
        return Deliverer(self.callbacks, CallbackSender(Receivers(LOOPBACK), [SECRET]), **more)


@pytest.fixture
def outbox(tmp_path: Path, receiver: Receiver) -> Iterator[Outbox]:
    outbox = Outbox(Settings(data_dir=tmp_path), receiver)
    yield outbox
    outbox.db.close()


def test_ten_attempts_on_the_schedule_of_the_standard_then_it_is_dead(
    outbox: Outbox, receiver: Receiver, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO, "worker.deliverer")
    receiver.answers = [500]
    job = outbox.fail_job()
    deliverer = outbox.deliverer(jitter=lambda delay_s: delay_s)
    waits = []
    for attempt in range(1, 11):
        assert deliverer.deliver_next()
        assert not deliverer.deliver_next()
        callback = outbox.only(job)
        assert (callback.attempts, callback.last_status) == (attempt, 500)
        if attempt < 10:
            assert callback.state is CallbackState.PENDING
            waits.append(outbox.let_time_pass())
    assert waits == pytest.approx([5, 300, 1800, *(hours * HOUR_S for hours in (2, 5, 10, 14, 20, 24))], abs=2)
    assert callback.state is CallbackState.DEAD
    assert len({(one.headers["webhook-id"], one.body) for one in receiver.received}) == 1
    assert len(receiver.received) == 10
    assert "is given up at attempt 10: answered 500; 1 callbacks are dead" in caplog.text
    assert "hook" not in caplog.text  # paths and queries may be secrets


def test_it_is_taken_after_a_failure(outbox: Outbox, receiver: Receiver) -> None:
    receiver.answers = [500, (302, receiver.url), 204]
    job = outbox.fail_job()
    deliverer = outbox.deliverer()
    for _ in range(3):
        assert deliverer.deliver_next()
        outbox.let_time_pass()
    callback = outbox.only(job)
    assert (callback.state, callback.attempts, callback.last_status, callback.last_error) == ("delivered", 3, 204, None)
    assert not deliverer.deliver_next()
    stamps = [int(one.headers["webhook-timestamp"]) for one in receiver.received]
    assert all(earlier <= later for earlier, later in pairwise(stamps))
    for one in receiver.received:
        assert Webhook(SECRET).verify(one.body, one.headers)["status"] == "failed"


def test_410_stops_at_once(outbox: Outbox, receiver: Receiver) -> None:
    receiver.answers = [410]
    job = outbox.fail_job()
    assert outbox.deliverer().deliver_next()
    assert (outbox.only(job).state, outbox.only(job).attempts) == ("dead", 1)


def test_jitter_is_at_most_a_tenth() -> None:
    waits = [add_jitter(100.0) for _ in range(1000)]
    assert 100 <= min(waits) < 102
    assert 108 < max(waits) <= 110
    assert len(DELAYS_S) == 9
    assert LEASE_S > 30


def deliver_until_killed(settings: Settings) -> None:
    """Another process' deliverer."""
    outbox = Outbox(settings, Receiver("", 0))
    outbox.deliverer().deliver_next()


def test_a_deliverer_killed_midway_is_replaced_and_the_message_keeps_its_id(outbox: Outbox, receiver: Receiver) -> None:
    job = outbox.fail_job()
    receiver.holding.set()
    victim = multiprocessing.get_context("spawn").Process(target=deliver_until_killed, args=(outbox.settings,))
    victim.start()
    receiver.wait_for(1)
    assert victim.pid is not None
    os.kill(victim.pid, signal.SIGKILL)
    victim.join()
    receiver.holding.clear()
    deliverer = outbox.deliverer()
    assert not deliverer.deliver_next()  # its lease still holds
    outbox.let_lease_run_out()
    assert deliverer.deliver_next()
    first, second = receiver.received
    assert first.headers["webhook-id"] == second.headers["webhook-id"] == outbox.only(job).id
    assert first.body == second.body
    assert (outbox.only(job).state, outbox.only(job).attempts) == ("delivered", 2)


def test_many_deliverers_deliver_once(outbox: Outbox, receiver: Receiver) -> None:
    jobs = [outbox.fail_job() for _ in range(12)]
    deliverers = [outbox.deliverer(poll_s=0.02) for _ in range(3)]
    for deliverer in deliverers:
        deliverer.start()
    receiver.wait_for(12)
    for deliverer in deliverers:
        deliverer.stop(10.0)
    assert len(receiver.received) == 12
    assert {json.loads(one.body)["jobID"] for one in receiver.received} == {job.id for job in jobs}
    assert {outbox.only(job).state for job in jobs} == {"delivered"}


def test_a_deliverer_that_is_told_to_stop_finishes_what_it_began(outbox: Outbox, receiver: Receiver) -> None:
    job = outbox.fail_job()
    receiver.holding.set()
    deliverer = outbox.deliverer(poll_s=0.02)
    deliverer.start()
    receiver.wait_for(1)
    deliverer.let_go()
    late = outbox.fail_job()
    threading.Timer(0.3, receiver.holding.clear).start()
    deliverer.stop(10.0)
    assert (outbox.only(job).state, outbox.only(late).attempts) == ("delivered", 0)


def test_a_database_that_is_away_is_waited_for(
    outbox: Outbox, receiver: Receiver, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    job = outbox.fail_job()
    away = threading.Event()
    away.set()
    real = outbox.callbacks.any_due

    def any_due() -> bool:
        if away.is_set():
            raise InternalError("database.unavailable", "away")
        return real()

    monkeypatch.setattr(outbox.callbacks, "any_due", any_due)
    deliverer = outbox.deliverer(poll_s=0.02, threads=1)
    deliverer.start()
    time.sleep(0.2)
    assert receiver.received == []
    away.clear()
    receiver.wait_for(1)
    deliverer.stop(10.0)
    assert outbox.only(job).state == "delivered"
    assert "callbacks wait" in caplog.text


def test_a_worker_tells_of_the_jobs_it_did(tmp_path: Path, valkey: ValkeyServer, receiver: Receiver) -> None:
    """The whole way: Celery, child, job table, deliverer, receiver; killed once in the middle of a delivery."""
    settings = make_settings(tmp_path, valkey, callback_secret=(SECRET,), callback_allow=LOOPBACK)
    service = Service(settings)
    callbacks = Callbacks(service.db)
    subscriber = Subscriber("http://127.0.0.1:8000/", receiver.url, receiver.url, receiver.url)
    try:
        receiver.holding.set()  # before there is a job: the worker may take it unasked
        service.start_worker()
        inputs = {"act": "sleep", "seconds": 5}  # so that its start is told while it runs
        job = service.jobs.create(DEFAULT_WORKSPACE, "validate", inputs, subscriber=subscriber)
        service.doorbell.ring(job.id, 1)
        receiver.wait_for(1)
        assert not service.jobs.get(DEFAULT_WORKSPACE, job.id).status.is_finished
        service.wait(job)
        receiver.wait_for(2)
        service.stop_workers(signal.SIGKILL)
        receiver.holding.clear()
        # that it started was not taken before it ended, and is forgotten
        assert [(one.event, one.state) for one in callbacks.of_job(DEFAULT_WORKSPACE, job.id)] == [("success", "pending")]
        with service.db.session() as session:
            session.execute(update(CallbackRow).values(lease_until=service.db.now(session) - timedelta(seconds=1)))
        service.start_worker()
        deadline = time.monotonic() + 60
        while {one.state for one in callbacks.of_job(DEFAULT_WORKSPACE, job.id)} != {"delivered"}:
            assert time.monotonic() < deadline, service.log()
            time.sleep(0.05)
        assert service.stop_workers() == [0], service.log()
        told = [Webhook(SECRET).verify(one.body, one.headers)["status"] for one in receiver.received]
        assert told == ["running", "successful", "successful"]
        assert len({one.headers["webhook-id"] for one in receiver.received}) == 2
        assert SECRET.removeprefix("whsec_") not in service.log()
    finally:
        service.close()
